/* Any description fits this model: the value of a reference below 50 is made of the reference, the
   element, the number of steps, and what stood 50 references above during the last step. There are
   as many elements as the reference modulo 5 says, counted from 1; one before FMI 3 (-DSCALARS). */
static const char GUID[] = "{table}";
enum { NX = 0, NZ = 0 };
static const unsigned STATES[1], RATES[1], INDICATORS[1];

static void flow(model *m, double dt) {
    for (unsigned r = 0; r < 50; r++)
        for (size_t j = 0; j < m->size[r]; j++) {
            const cell *in = &m->v[r + 50][j];
            cell *out = &m->v[r][j];
            int made = (int)(7 * r + 3 * j + 11 * m->steps) % 50;
            out->d = made + 0.25 + in->d;
            out->i = made + in->i;
            out->length = snprintf(out->text, TEXT, "%d %.20s", made, in->text);
        }
}
static void start(model *m) {
    for (unsigned r = 0; r < REFERENCES; r++) {
#ifdef SCALARS
        m->size[r] = 1;
#else
        m->size[r] = 1 + r % 5;
#endif
    }
    flow(m, 0.0);
}
static double ahead(const model *m) { return NEVER; }
static void evaluate(model *m) {}
static void event(model *m) {}
static bool wants_event(const model *m) { return false; }
static void set_clock(model *m, unsigned r) {}
static bool get_clock(const model *m, unsigned r) { return false; }
static bool interval(model *m, unsigned r, double *seconds) { return false; }
