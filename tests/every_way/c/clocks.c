/* Clocks: `tick` every 1/8 s; each third tick starts the countdown `down` of 1/16 s, at whose end
   x (x' = -x) rises by 1; `user` is triggered from outside; `even` ticks with every other tick. */
enum { X = 1, DX, TICKS, DOWNS, USERS, TOTAL, EVENS, TICK = 10, DOWN, USER, EVEN };
static const char GUID[] = "{clocks}";
enum { NX = 1, NZ = 0, TICKING = 50, STARTED, ENDED };
static const unsigned STATES[] = {X}, RATES[] = {DX}, INDICATORS[1];

static void start(model *m) {
    declare(m, X, EVENS, 1);
    D(X) = 1.0;
}
static void evaluate(model *m) {
    D(DX) = -D(X);
    I(TOTAL) = I(TICKS) + 100 * I(DOWNS) + 10000 * I(USERS);
}
static double ahead(const model *m) { return NEVER; }
static void flow(model *m, double dt) { D(X) *= exp(-dt); }
static void event(model *m) {
    if (I(ENDED)) D(X) += 1.0, m->values_changed = true;
    I(TICKING) = I(ENDED) = 0;
}
static bool wants_event(const model *m) { return false; }
static bool get_clock(const model *m, unsigned r) { return I(TICKING) && I(TICKS) % 2 == 0; }
static void set_clock(model *m, unsigned r) {
    if (r == TICK) {
        I(TICKS)++, I(TICKING) = 1;
        if (I(TICKS) % 2 == 0) I(EVENS)++;
        if (I(TICKS) % 3 == 0) I(STARTED) = 1;
    }
    if (r == DOWN) I(DOWNS)++, I(ENDED) = 1;
    if (r == USER) I(USERS)++;
}
static bool interval(model *m, unsigned r, double *seconds) {
    bool changed = r == TICK || I(STARTED);
    *seconds = r == TICK ? 0.125 : 0.0625;
    if (r == DOWN) I(STARTED) = 0;
    return changed;
}
