/* The model of the test FMUs, solved exactly: x' = u - k x with u held, a ball of height h that
   bounces with restitution e, and a counter with a time event every 0.25 s. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define NEVER 1e300
#define G 9.81

typedef struct {
    double t, x, h, v, k, u, e, next, start, end_at;
    int counter, steps, completed;
    bool in_event_mode, step_event;
} plant;

static void plant_reset(plant *p) {
    memset(p, 0, sizeof *p);
    p->x = 1.0, p->h = 1.0, p->k = 1.0, p->e = 0.7, p->end_at = NEVER;
}

static void plant_begin(plant *p, double start) {
    p->t = p->start = start;
    p->next = start + 0.25;
}

static double rate_x(const plant *p) { return p->u - p->k * p->x; }

static void fly(plant *p, double dt) {
    double rest = p->k == 0.0 ? 0.0 : p->u / p->k;
    p->x = rest + (p->x - rest) * exp(-p->k * dt);
    p->h += p->v * dt - 0.5 * G * dt * dt;
    p->v -= G * dt;
    p->t += dt;
}

/* Time until the ball touches the ground, from a flight that starts on or above it. */
static double impact(const plant *p) {
    if (p->h <= 0.0 && p->v <= 0.0) return 0.0;
    return (p->v + sqrt(p->v * p->v + 2.0 * G * fmax(p->h, 0.0))) / G;
}

static void bounce(plant *p) {
    p->h = 0.0;
    p->v = -p->e * p->v;
}

/* All events that are due; true where the states jumped. */
static bool handle(plant *p, bool at_ground) {
    bool jumped = false;
    if (at_ground && p->v < 0.0) bounce(p), jumped = true;
    if (p->t >= p->next - 1e-12) {
        p->counter++;
        p->next = p->start + 0.25 * (p->counter + 1);
    }
    return jumped;
}

/* Go on to `stop`, or to the first event where `until_event`; true where it stopped for one. */
static bool advance(plant *p, double stop, bool until_event) {
    while (p->t < stop) {
        double ground = p->t + impact(p), first = fmin(ground, p->next);
        if (first > stop + 1e-12) {
            fly(p, stop - p->t);
            p->t = stop;
            return false;
        }
        fly(p, first - p->t);
        p->t = first;
        if (until_event) {
            if (first == ground) p->h = 0.0;
            return true;
        }
        handle(p, first == ground);
    }
    return false;
}
