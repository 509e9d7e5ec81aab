/* What all peers share. Each model is a struct with its parameters and its state, a step function for the
 * fixed-step form and, if it has states, what RK4() asks for. Equations and memory rules are those in the
 * heads of friction_model/src/MODEL.rs; velocity, parameters and order of operations are the Rust side's,
 * so that the sums of forces must agree. */
#ifndef PEER_H
#define PEER_H

#include <math.h>
#include <stdio.h>
#include <time.h>

#define SAMPLES 4096
#define PI 3.14159265358979323846

/* Half a millisecond apart for RK4, which needs the middle of a step; a millisecond for the rest. */
extern double velocity[SAMPLES];

/* Period [s], and the Gaussian shape exponent: numbers that the compiler cannot know. */
extern double period, gaussian;

static inline double between(double low, double high, double x)
{
    x = x > high ? high : x;
    return x < low ? low : x;
}

static inline double saturate(double bound, double x)
{
    return x > bound ? bound : x < -bound ? -bound : x;
}

static inline double sign(double v)
{
    return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0;
}

/* Any velocity a sensor may deliver: not a number counts as standing, the rest is cut to +-1e6. */
static inline double bounded(double v)
{
    return v != v ? 0.0 : saturate(1e6, v);
}

/* ---- Stribeck curve ------------------------------------------------------------------------------ */

struct curve {
    double f_s, f_c, inverse_v_s, delta;
};

static inline double level(const struct curve *c, double v)
{
    double r = v * c->inverse_v_s;
    double power = c->delta == 2.0 ? r * r : pow(fabs(r), c->delta);
    return c->f_c + (c->f_s - c->f_c) * exp(-power);
}

static inline struct curve stribeck_curve(double f_s, double f_c, double v_s)
{
    return (struct curve){.f_s = f_s, .f_c = f_c, .inverse_v_s = 1.0 / v_s, .delta = gaussian};
}

/* ---- Measurement --------------------------------------------------------------------------------- */

static inline double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Each loop in a function of its own that knows no parameter at compile time; a first pass of a tenth
 * of the steps, from which the state goes on, warms caches and clock. */
#define REPORT(model, scheme, m, steps)                                                                \
    do {                                                                                               \
        double warm = model##_run_##scheme(m, (steps) / 10);                                           \
        double start = now();                                                                          \
        double sum = model##_run_##scheme(m, steps);                                                   \
        double end = now();                                                                            \
        printf(#model " " #scheme " %.4f %.17e\n", (end - start) / (double)(steps)*1e9, warm + sum);   \
    } while (0)

/* A model without states: struct MODEL, MODEL_step(m, v), MODEL_start(m). */
#define MEASURE_STEP(model, type)                                                                      \
    static __attribute__((noipa)) double model##_run_exact(type *m, long steps)                        \
    {                                                                                                  \
        double sum = 0.0;                                                                              \
        for (long k = 0; k < steps; k++)                                                               \
            sum += model##_step(m, velocity[k % SAMPLES]);                                             \
        return sum;                                                                                    \
    }                                                                                                  \
    static void model##_measure_exact(long steps)                                                      \
    {                                                                                                  \
        type m;                                                                                        \
        model##_start(&m);                                                                             \
        REPORT(model, exact, &m, steps);                                                               \
    }

/* A model with states; besides the above MODEL_rk4(m, v, h). */
#define MEASURE_RK4(model, type)                                                                       \
    static __attribute__((noipa)) double model##_run_rk4(type *m, long steps)                          \
    {                                                                                                  \
        double sum = 0.0, h = period;                                                                  \
        for (long k = 0; k < steps; k++) {                                                             \
            long at = 2 * k;                                                                           \
            double v[3] = {velocity[at % SAMPLES], velocity[(at + 1) % SAMPLES],                       \
                           velocity[(at + 2) % SAMPLES]};                                              \
            sum += model##_rk4(m, v, h);                                                               \
        }                                                                                              \
        return sum;                                                                                    \
    }                                                                                                  \
    static void model##_measure_rk4(long steps)                                                        \
    {                                                                                                  \
        type m;                                                                                        \
        model##_start(&m);                                                                             \
        REPORT(model, rk4, &m, steps);                                                                 \
    }

#define MEMORYLESS(model, type)                                                                        \
    MEASURE_STEP(model, type)                                                                          \
    void measure_##model(long steps) { model##_measure_exact(steps); }

#define DYNAMIC(model, type)                                                                           \
    MEASURE_STEP(model, type)                                                                          \
    MEASURE_RK4(model, type)                                                                           \
    void measure_##model(long steps)                                                                   \
    {                                                                                                  \
        model##_measure_exact(steps);                                                                  \
        model##_measure_rk4(steps);                                                                    \
    }

/* ---- Classical Runge-Kutta method, velocity given at start, middle and end ------------------------ */

/* For a struct MODEL with the states double x[N]:
 *   double MODEL_level(m, v)                    what the rates need that depends on v alone, computed once for each v
 *   void MODEL_rates(m, x, v, level, rates)     time derivatives of x
 *   double MODEL_arrive(m, v, level)            accepts the step: bounds the states, moves the memory; the force there
 */
#define RK4(model, type, N)                                                                            \
    static inline double model##_rk4(type *restrict m, const double v[3], double h)                    \
    {                                                                                                  \
        double middle = model##_level(m, v[1]), end = model##_level(m, v[2]);                          \
        double x[N], k1[N], k2[N], k3[N], k4[N];                                                       \
        model##_rates(m, m->x, v[0], model##_level(m, v[0]), k1);                                      \
        for (int i = 0; i < N; i++)                                                                    \
            x[i] = m->x[i] + 0.5 * h * k1[i];                                                          \
        model##_rates(m, x, v[1], middle, k2);                                                         \
        for (int i = 0; i < N; i++)                                                                    \
            x[i] = m->x[i] + 0.5 * h * k2[i];                                                          \
        model##_rates(m, x, v[1], middle, k3);                                                         \
        for (int i = 0; i < N; i++)                                                                    \
            x[i] = m->x[i] + h * k3[i];                                                                \
        model##_rates(m, x, v[2], end, k4);                                                            \
        for (int i = 0; i < N; i++)                                                                    \
            m->x[i] += h / 6.0 * k1[i] + h / 3.0 * k2[i] + h / 3.0 * k3[i] + h / 6.0 * k4[i];          \
        return model##_arrive(m, v[2], end);                                                           \
    }

#endif
