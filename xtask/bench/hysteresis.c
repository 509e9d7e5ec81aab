/* Models over a hysteresis with non-local memory: the proposed one and Leuven's. */
#include "peer.h"

#define CAPACITY 120
#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* ---- Hysteresis: a virgin curve, Masing's doubling and a stack of reversal points ------------------ */

/* Ends at the force `end`; `slope` is its steepest. */
struct virgin {
    double end, wave_number, slope;
};

/* `bend` is pi/2 for a sine, which ends flat, and 1 for a line. */
static struct virgin virgin(double end, double z_b, double bend)
{
    double wave_number = bend / z_b;
    return (struct virgin){.end = end, .wave_number = wave_number, .slope = end * wave_number};
}

typedef double virgin_curve(const struct virgin *curve, double z);

ALWAYS_INLINE double sine(const struct virgin *curve, double z)
{
    return curve->end * sin(curve->wave_number * z);
}

ALWAYS_INLINE double line(const struct virgin *curve, double z)
{
    return curve->slope * z;
}

struct point {
    double z, f;
};

struct hysteresis {
    struct virgin virgin;
    /* Direction of the present branch, where it stands, the reversals behind it. */
    double direction;
    struct point last;
    int depth;
    struct point reversal[CAPACITY];
};

/* The force at z, moving in direction s with *depth reversals behind; closed loops are taken off *depth. */
ALWAYS_INLINE double follow(const struct hysteresis *h, virgin_curve *curve, double s, double z, int *depth)
{
    while (*depth > 0) {
        const struct point *top = &h->reversal[*depth - 1];
        double closes_at = *depth >= 2 ? top[-1].z : -top->z;
        if (s * (z - closes_at) < 0.0)
            return top->f + 2.0 * s * curve(&h->virgin, 0.5 * s * (z - top->z));
        *depth -= *depth >= 2 ? 2 : 1;
    }
    return curve(&h->virgin, z);
}

ALWAYS_INLINE void move(struct hysteresis *h, virgin_curve *curve, double z)
{
    if (z == h->last.z)
        return;
    double s = z > h->last.z ? 1.0 : -1.0;
    if (h->direction != 0.0 && s != h->direction) {
        if (h->depth == CAPACITY)
            h->depth -= 2;
        h->reversal[h->depth++] = h->last;
    }
    h->direction = s;
    h->last.f = follow(h, curve, s, z, &h->depth);
    h->last.z = z;
}

/* The force that a move would give. */
ALWAYS_INLINE double peek(const struct hysteresis *h, virgin_curve *curve, double z)
{
    if (z == h->last.z)
        return h->last.f;
    double s = z > h->last.z ? 1.0 : -1.0;
    int depth = h->depth;
    if (h->direction != 0.0 && s != h->direction) {
        if (depth == CAPACITY)
            depth -= 2;
        double closes_at = depth > 0 ? h->reversal[depth - 1].z : -h->last.z;
        if (s * (z - closes_at) < 0.0)
            return h->last.f + 2.0 * s * curve(&h->virgin, 0.5 * s * (z - h->last.z));
        depth -= depth > 0;
    }
    return follow(h, curve, s, z, &depth);
}

/* ---- Proposed: lag, hysteresis, implicit step of the deflection; over the sine and over the line --- */

struct proposed {
    struct curve curve;
    double sigma, inverse_sigma, tau, f_v, z_b, dt, gamma_decay, implicit_gain;
    /* gamma and z. */
    double x[2];
    struct hysteresis memory;
};

static void start(struct proposed *m, double bend)
{
    *m = (struct proposed){.sigma = 0.3213, .tau = 0.0011, .f_v = 0.0403, .z_b = 0.006, .dt = period};
    m->curve = stribeck_curve(0.0994, 0.0925, 0.1407);
    m->memory.virgin = virgin(m->curve.f_s, m->z_b, bend);
    m->inverse_sigma = 1.0 / m->sigma;
    m->gamma_decay = exp(-m->dt / m->tau);
    m->implicit_gain = 1.0 / (m->sigma + m->memory.virgin.slope * m->dt);
    m->x[0] = m->curve.f_s;
}

ALWAYS_INLINE double step(struct proposed *restrict m, virgin_curve *shape, double v)
{
    v = bounded(v);
    double gamma = m->x[0], z = m->x[1], hysteresis = m->memory.last.f;
    double contact = saturate(gamma, hysteresis + m->sigma * v);
    double slowest = (-gamma - hysteresis) * m->implicit_gain;
    double fastest = (gamma - hysteresis) * m->implicit_gain;
    double g = level(&m->curve, v);
    z = saturate(m->z_b, z + m->dt * between(slowest, fastest, v));
    move(&m->memory, shape, z);
    m->x[0] = g + (gamma - g) * m->gamma_decay;
    m->x[1] = z;
    return contact + m->f_v * v;
}

ALWAYS_INLINE void rates(const struct proposed *m, virgin_curve *shape, const double *x, double v, double g,
                         double *rates)
{
    double hysteresis = peek(&m->memory, shape, saturate(m->z_b, x[1]));
    double contact = saturate(x[0], hysteresis + m->sigma * v);
    rates[0] = (g - x[0]) / m->tau;
    rates[1] = (contact - hysteresis) * m->inverse_sigma;
}

ALWAYS_INLINE double arrive(struct proposed *m, virgin_curve *shape, double v)
{
    m->x[0] = between(m->curve.f_c, m->curve.f_s, m->x[0]);
    m->x[1] = saturate(m->z_b, m->x[1]);
    move(&m->memory, shape, m->x[1]);
    return saturate(m->x[0], m->memory.last.f + m->sigma * v) + m->f_v * v;
}


#define PROPOSED(model, shape, bend)                                                                   \
    static void model##_start(struct proposed *m) { start(m, bend); }                                  \
    static inline double model##_step(struct proposed *m, double v) { return step(m, shape, v); }      \
    static inline double model##_level(const struct proposed *m, double v) { return level(&m->curve, v); }\
    static inline void model##_rates(const struct proposed *m, const double *x, double v, double g,    \
                                     double *dx)                                                       \
    {                                                                                                  \
        rates(m, shape, x, v, g, dx);                                                                  \
    }                                                                                                  \
    static inline double model##_arrive(struct proposed *m, double v, double g)                        \
    {                                                                                                  \
        (void)g;                                                                                       \
        return arrive(m, shape, v);                                                                    \
    }                                                                                                  \
    RK4(model, struct proposed, 2)                                                                     \
    DYNAMIC(model, struct proposed)

PROPOSED(proposed, sine, PI / 2.0)
PROPOSED(proposed_linear, line, 1.0)

/* ---- Leuven, as modified by Lampaert, Swevers and Al-Bender --------------------------------------- */

struct leuven {
    struct curve curve;
    double z_b, n, sigma1, f_v, dt;
    double x[1];
    struct hysteresis memory;
};

static void leuven_start(struct leuven *m)
{
    *m = (struct leuven){.z_b = 0.006, .n = gaussian, .sigma1 = 0.3213, .f_v = 0.0403, .dt = period};
    m->curve = stribeck_curve(0.0994, 0.0925, 0.1407);
    m->memory.virgin = virgin(0.0994, m->z_b, PI / 2.0);
}

static inline double leuven_level(const struct leuven *m, double v)
{
    return level(&m->curve, v);
}

/* The part of the motion that deflects the bristles; r, the load relative to the sliding level. */
static inline double leuven_elastic(const struct leuven *m, double hysteresis, double v, double g, double *r)
{
    *r = hysteresis * sign(v) / g;
    double magnitude = fabs(*r);
    double power = m->n == 2.0 ? magnitude * magnitude : pow(magnitude, m->n);
    return 1.0 - sign(*r) * power;
}

/* Slope of the sine's branch where the deflection stands, or of a new one where `direction` turns. */
static inline double leuven_slope(const struct leuven *m, double direction)
{
    const struct hysteresis *h = &m->memory;
    double z = 0.0;
    if (h->direction * direction > 0.0)
        z = h->depth > 0 ? 0.5 * (h->last.z - h->reversal[h->depth - 1].z) : h->last.z;
    return fabs(z) >= m->z_b ? 0.0 : h->virgin.slope * cos(h->virgin.wave_number * z);
}

/* The deflection between two at which the hysteresis carries g: false position, Illinois form. */
static double leuven_sliding(const struct leuven *m, double direction, double g, double low, double high)
{
    double below = direction * peek(&m->memory, sine, low) - g;
    double above = direction * peek(&m->memory, sine, high) - g;
    double last = 0.0;
    for (int i = 0; i < 30; i++) {
        double z = low + (high - low) * (below / (below - above));
        double here = direction * peek(&m->memory, sine, z) - g;
        if (here > 0.0) {
            high = z, above = here;
            if (last > 0.0)
                below *= 0.5;
        } else {
            low = z, below = here;
            if (last < 0.0)
                above *= 0.5;
            if (-here <= 4.0 * 2.220446049250313e-16 * g)
                break;
        }
        last = here > 0.0 ? 1.0 : -1.0;
    }
    return low;
}

static inline double leuven_step(struct leuven *restrict m, double v)
{
    v = bounded(v);
    double g = level(&m->curve, v), hysteresis = m->memory.last.f, r;
    double elastic = leuven_elastic(m, hysteresis, v, g, &r);
    double direction = sign(v);
    double power = m->n == 2.0 ? fabs(r) : pow(fabs(r), m->n - 1.0);
    double fall = m->n * power * leuven_slope(m, direction * elastic) / g;
    double travel = fabs(v) * m->dt;
    double relaxed = fall * travel < 1e-8 ? travel : -expm1(-fall * travel) / fall;
    double moved = elastic * relaxed, forward = direction * hysteresis;
    double next = saturate(m->z_b, m->x[0] + direction * moved);
    int may_pass = forward < g && forward + m->memory.virgin.slope * moved > g;
    if (may_pass && direction * peek(&m->memory, sine, next) > g)
        next = leuven_sliding(m, direction, g, m->x[0], next);
    m->x[0] = next;
    move(&m->memory, sine, next);
    return hysteresis + m->sigma1 * v * elastic + m->f_v * v;
}

static inline void leuven_rates(const struct leuven *m, const double *x, double v, double g, double *rates)
{
    double r, hysteresis = peek(&m->memory, sine, saturate(m->z_b, x[0]));
    rates[0] = v * leuven_elastic(m, hysteresis, v, g, &r);
}

static inline double leuven_arrive(struct leuven *m, double v, double g)
{
    m->x[0] = saturate(m->z_b, m->x[0]);
    move(&m->memory, sine, m->x[0]);
    double r, hysteresis = m->memory.last.f;
    return hysteresis + m->sigma1 * v * leuven_elastic(m, hysteresis, v, g, &r) + m->f_v * v;
}

RK4(leuven, struct leuven, 1)
DYNAMIC(leuven, struct leuven)
