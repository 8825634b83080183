/* Events of all kinds: a room T' = ambient + 30 heater - T with a thermostat between 19 and 21
   (state events); a counter every 0.25 s whose events take three iterations (time events, chains);
   laps of 0.5 s that only a step event counts; x' = -x, which jumps to 1000, as its nominal does,
   at 1 s. */
enum { T = 1, DT, X, DX, Z, AMBIENT, HEATER, COUNTER, CHAIN, LAPS };
static const char GUID[] = "{thermostat}";
enum { NX = 2, NZ = 1 };
static const unsigned STATES[] = {T, X}, RATES[] = {DT, DX}, INDICATORS[] = {Z};

static void start(model *m) {
    declare(m, T, LAPS, 1);
    D(T) = 20.0, D(X) = 1.0, D(AMBIENT) = 5.0, I(HEATER) = 1;
}
static double rest(const model *m) { return D(AMBIENT) + (I(HEATER) ? 30.0 : 0.0); }
static void evaluate(model *m) {
    D(DT) = rest(m) - D(T);
    D(DX) = -D(X);
    D(Z) = I(HEATER) ? 21.0 - D(T) : D(T) - 19.0;
}
static double ahead(const model *m) {
    double limit = I(HEATER) ? 21.0 : 19.0;
    double reached = m->t + log((rest(m) - D(T)) / (rest(m) - limit));
    return fmin(m->next, reached);
}
static void flow(model *m, double dt) {
    D(T) = rest(m) + (D(T) - rest(m)) * exp(-dt);
    D(X) *= exp(-dt);
}
static void event(model *m) {
    if (m->next == NEVER) m->next = m->begin + 0.25;
    if (m->asked) I(LAPS) = (int64_t)floor(2.0 * (m->t - m->begin) + 1e-9);
    if (m->t >= m->next && m->iteration < 3) {
        I(CHAIN)++;
        m->needs_update = m->iteration < 2;
        if (m->needs_update) return;
        I(COUNTER)++;
        m->next = m->begin + 0.25 * (I(COUNTER) + 1);
        if (I(COUNTER) == 4) {
            D(X) = m->nominals[1] = 1000.0;
            m->values_changed = m->nominals_changed = true;
        }
    }
    if (D(Z) < 1e-9) I(HEATER) = !I(HEATER);
}
static bool wants_event(const model *m) {
    return floor(2.0 * (m->t - m->begin) + 1e-9) > I(LAPS);
}
static void set_clock(model *m, unsigned r) {}
static bool get_clock(const model *m, unsigned r) { return false; }
static bool interval(model *m, unsigned r, double *seconds) { return false; }
