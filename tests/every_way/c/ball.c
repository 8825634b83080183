/* A ball that bounces: h' = v, v' = u - g; v becomes -e v on the ground. */
#define G 9.81
enum { H = 1, V, A, U, E, BOUNCES, FALLING };
static const char GUID[] = "{ball}";
enum { NX = 2, NZ = 1 };
static const unsigned STATES[] = {H, V}, RATES[] = {V, A}, INDICATORS[] = {H};

static void start(model *m) {
    declare(m, H, FALLING, 1);
    D(H) = 1.0, D(E) = 0.7;
}
static void evaluate(model *m) {
    D(A) = D(U) - G;
    I(FALLING) = D(V) < 0.0;
}
static double ahead(const model *m) {
    double fall = G - D(U), h = fmax(D(H), 0.0);
    return m->t + (D(V) + sqrt(D(V) * D(V) + 2.0 * fall * h)) / fall;
}
static void flow(model *m, double dt) {
    double a = D(U) - G;
    D(H) += D(V) * dt + 0.5 * a * dt * dt;
    D(V) += a * dt;
}
static void event(model *m) {
    if (D(H) > 1e-9 || D(V) >= 0.0) return;
    D(H) = 0.0, D(V) = -D(E) * D(V);
    I(BOUNCES)++;
    m->values_changed = true;
}
static bool wants_event(const model *m) { return false; }
static void set_clock(model *m, unsigned r) {}
static bool get_clock(const model *m, unsigned r) { return false; }
static bool interval(model *m, unsigned r, double *seconds) { return false; }
