/* Variables of all types: each echoes what its input was during the last step; others count the steps, beyond 2^53 too; arrays
   are sized by a structural parameter. The references of a type's input and output are neighbours,
   in the order of `TYPES` in descriptions.py. */
enum { STEPS = 1, LARGE, LARGEST, THIRD, LABEL, BYTES, ODD, SIZE, TOLERANCE, ECHO };
enum { W = 40, DOUBLED, TABLE };
static const char GUID[] = "{types}";
enum { NX = 0, NZ = 0 };
static const unsigned STATES[1], RATES[1], INDICATORS[1];

static void start(model *m) {
    declare(m, STEPS, TOLERANCE, 1);
    m->structural = SIZE;
    declare(m, ECHO, ECHO + 27, 1);
    I(SIZE) = 3, I(ECHO + 26) = I(ECHO + 27) = 1;
    for (int j = 0; j < MOST; j++) m->v[W][j].d = j + 1;
}
static void evaluate(model *m) {
    declare(m, W, DOUBLED, I(SIZE));
    declare(m, TABLE, TABLE, 2 * I(SIZE));
    for (int64_t j = 0; j < I(SIZE); j++) {
        m->v[DOUBLED][j].d = 2.0 * m->v[W][j].d + m->steps;
        for (int b = 0; b < 2; b++) m->v[TABLE][2 * j + b].d = 10 * (j + 1) + b + 1 + m->steps;
    }
    I(STEPS) = m->steps;
    I(LARGE) = 9007199254740993 + m->steps;
    I(LARGEST) = -1 - m->steps;
    D(THIRD) = (float)(m->steps / 3.0);
    I(ODD) = m->steps % 2;
    D(TOLERANCE) = m->tolerance;
    snprintf(m->v[LABEL][0].text, TEXT, "step %d", m->steps);
    memcpy(m->v[BYTES][0].text, (char[]){(char)m->steps, 0, (char)255}, 3);
    m->v[BYTES][0].length = 3;
}
static double ahead(const model *m) { return NEVER; }
static void flow(model *m, double dt) {
    for (unsigned r = ECHO; r < ECHO + 28; r += 2) m->v[r + 1][0] = m->v[r][0];
}
static void event(model *m) {}
static bool wants_event(const model *m) { return false; }
static void set_clock(model *m, unsigned r) {}
static bool get_clock(const model *m, unsigned r) { return false; }
static bool interval(model *m, unsigned r, double *seconds) { return false; }
