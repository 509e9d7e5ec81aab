/* The fixed-step forms of friction_model as a C programmer would write them: the peer of
 * friction_model/examples/step_bench.rs, for `cargo xtask bench`.
 *
 *     gcc -O3 -march=native peer.c -lm && ./a.out 2000000
 *
 * prints, for each model, its name, nanoseconds a step and the sum of all forces. Equations and memory
 * rules are those in the heads of friction_model/src/lugre.rs, proposed.rs and hysteresis.rs; velocity,
 * parameters and order of operations are the Rust side's, so that the sums must agree.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define SAMPLES 4096
#define CAPACITY 120

static const double PI = 3.14159265358979323846;

static double velocity[SAMPLES];

/* Any velocity a sensor may deliver: not a number counts as standing, the rest is cut to +-1e6. */
static inline double bounded(double v)
{
    if (v != v)
        return 0.0;
    return v > 1e6 ? 1e6 : v < -1e6 ? -1e6 : v;
}

static inline double saturate(double bound, double x)
{
    return x > bound ? bound : x < -bound ? -bound : x;
}

/* ---- Stribeck curve ---------------------------------------------------------------------------- */

struct curve {
    double f_s, f_c, inverse_v_s, delta;
};

static inline double level(const struct curve *c, double v)
{
    double r = v * c->inverse_v_s;
    double power = c->delta == 2.0 ? r * r : pow(fabs(r), c->delta);
    return c->f_c + (c->f_s - c->f_c) * exp(-power);
}

struct stribeck {
    struct curve curve;
    double f_v;
};

static inline double stribeck_step(const struct stribeck *m, double v)
{
    v = bounded(v);
    double sign = v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0;
    return sign * level(&m->curve, v) + m->f_v * v;
}

/* ---- LuGre, exact for a held velocity ---------------------------------------------------------- */

struct lugre {
    struct curve curve;
    double sigma0, sigma1, f_v, dt;
    double z;
};

static inline double lugre_step(struct lugre *m, double v)
{
    v = bounded(v);
    double z = m->z;
    double g = level(&m->curve, v);
    double rate = m->sigma0 * fabs(v) / g;
    double z_steady = copysign(g / m->sigma0, v);
    m->z = z_steady + (z - z_steady) * exp(-rate * m->dt);
    return m->sigma0 * z + m->sigma1 * (v - rate * z) + m->f_v * v;
}

/* ---- Proposed: lag, hysteresis with non-local memory, implicit step of the deflection ----------- */

struct point {
    double z, f;
};

struct proposed {
    struct curve curve;
    double sigma, f_v, z_b, wave_number;
    double dt, gamma_decay, implicit_gain;
    double gamma, z;
    /* Memory: direction of the present branch, where it stands, the reversals behind it. */
    double direction;
    struct point last;
    int depth;
    struct point reversal[CAPACITY];
};

static inline double virgin(const struct proposed *m, double z)
{
    return m->curve.f_s * sin(m->wave_number * z);
}

static inline void move(struct proposed *m, double z)
{
    if (z == m->last.z)
        return;
    double s = z > m->last.z ? 1.0 : -1.0;
    if (m->direction != 0.0 && s != m->direction) {
        if (m->depth == CAPACITY)
            m->depth -= 2;
        m->reversal[m->depth++] = m->last;
    }
    m->direction = s;
    double force;
    for (;;) {
        if (m->depth == 0) {
            force = virgin(m, z);
            break;
        }
        const struct point *top = &m->reversal[m->depth - 1];
        double closes_at = m->depth >= 2 ? top[-1].z : -top->z;
        if (s * (z - closes_at) < 0.0) {
            force = top->f + 2.0 * s * virgin(m, 0.5 * s * (z - top->z));
            break;
        }
        m->depth -= m->depth >= 2 ? 2 : 1;
    }
    m->last.z = z;
    m->last.f = force;
}

static inline double proposed_step(struct proposed *m, double v)
{
    v = bounded(v);
    double hysteresis = m->last.f;
    double contact = saturate(m->gamma, hysteresis + m->sigma * v);
    double slowest = (-m->gamma - hysteresis) * m->implicit_gain;
    double fastest = (m->gamma - hysteresis) * m->implicit_gain;
    double rate = v > fastest ? fastest : v;
    rate = rate < slowest ? slowest : rate;
    double g = level(&m->curve, v);
    m->z = saturate(m->z_b, m->z + m->dt * rate);
    move(m, m->z);
    m->gamma = g + (m->gamma - g) * m->gamma_decay;
    return contact + m->f_v * v;
}

/* ---- Measurement --------------------------------------------------------------------------------- */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Each loop in a function of its own that knows no parameter at compile time; a first pass of a tenth
 * of the steps, from which the state goes on, warms caches and clock. */
#define MEASURE(model, step_function)                                                                  \
    static __attribute__((noinline)) double run_##model(struct model *m, long steps)                   \
    {                                                                                                  \
        double sum = 0.0;                                                                              \
        for (long k = 0; k < steps; k++)                                                               \
            sum += step_function(m, velocity[k % SAMPLES]);                                            \
        return sum;                                                                                    \
    }                                                                                                  \
    static void measure_##model(struct model *m, long steps)                                           \
    {                                                                                                  \
        double warm = run_##model(m, steps / 10);                                                      \
        double start = now();                                                                          \
        double sum = run_##model(m, steps);                                                            \
        double end = now();                                                                            \
        printf(#model " %.4f %.17e\n", (end - start) / (double)steps * 1e9, warm + sum);               \
    }

MEASURE(stribeck, stribeck_step)
MEASURE(lugre, lugre_step)
MEASURE(proposed, proposed_step)

int main(int argc, char **argv)
{
    long steps = argc > 1 ? atol(argv[1]) : 0;
    if (steps < 10) {
        fprintf(stderr, "usage: peer STEPS (at least 10)\n");
        return 2;
    }
    for (int i = 0; i < SAMPLES; i++) {
        double phase = 2.0 * PI * (double)i / SAMPLES;
        velocity[i] = 0.02 + 0.2 * sin(3.0 * phase) + 0.01 * sin(41.0 * phase);
    }
    /* Numbers that the compiler cannot know. */
    volatile double two = 2.0, dt = 1e-3;

    struct curve curve = {.f_s = 0.0994, .f_c = 0.0925, .inverse_v_s = 1.0 / 0.1407, .delta = two};
    struct stribeck stribeck = {.curve = curve, .f_v = 0.0403};
    measure_stribeck(&stribeck, steps);

    struct curve lugre_curve = {.f_s = 0.0994, .f_c = 0.0929, .inverse_v_s = 1.0 / 0.1407, .delta = two};
    struct lugre lugre = {.curve = lugre_curve, .sigma0 = 16.469, .sigma1 = 0.2494, .f_v = 0.0403, .dt = dt};
    measure_lugre(&lugre, steps);

    static struct proposed proposed;
    proposed.curve = curve;
    proposed.sigma = 0.3213;
    proposed.f_v = 0.0403;
    proposed.z_b = 0.006;
    proposed.wave_number = PI / 2.0 / proposed.z_b;
    proposed.dt = dt;
    proposed.gamma_decay = exp(-dt / 0.0011);
    proposed.implicit_gain = 1.0 / (proposed.sigma + curve.f_s * proposed.wave_number * dt);
    proposed.gamma = curve.f_s;
    measure_proposed(&proposed, steps);
    return 0;
}
