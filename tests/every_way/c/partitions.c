/* Scheduled execution: `fast` every 1/8 s moves x towards u and each third time starts the countdown
   `down` of 1/16 s, which halves y; `slow` every 1/4 s, after `fast`, adds x to y. */
enum { X = 1, Y, TOTAL, U, FAST = 10, SLOW, DOWN };
static const char GUID[] = "{partitions}";
enum { NX = 0, NZ = 0, RUNS = 50, STARTED };
static const unsigned STATES[1], RATES[1], INDICATORS[1];

static void start(model *m) {
    declare(m, X, U, 1);
    D(U) = 1.0;
}
static void evaluate(model *m) {}
static double ahead(const model *m) { return NEVER; }
static void flow(model *m, double dt) {}
static void event(model *m) {}
static bool wants_event(const model *m) { return false; }
static bool get_clock(const model *m, unsigned r) { return false; }
static void set_clock(model *m, unsigned r) {
    if (r == FAST) {
        D(X) += 0.125 * (D(U) - D(X));
        I(TOTAL)++;
        I(STARTED) = ++I(RUNS) % 3 == 0;
        m->asked = I(STARTED);
    }
    if (r == SLOW) D(Y) += D(X), I(TOTAL) += 100;
    if (r == DOWN) D(Y) *= 0.5, I(TOTAL) += 10000;
}
static bool interval(model *m, unsigned r, double *seconds) {
    bool changed = r != DOWN || I(STARTED);
    *seconds = r == FAST ? 0.125 : r == SLOW ? 0.25 : 0.0625;
    if (r == DOWN) I(STARTED) = 0;
    return changed;
}
