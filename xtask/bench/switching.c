/* Models that change between sticking and sliding by rules: Wojewoda's and Armstrong-Helouvry's. */
#include "peer.h"

/* ---- Wojewoda, Stefanski, Wiercigroch and Kapitaniak: the sign of the acceleration chooses the branch -- */

struct wojewoda {
    double f_s, f_c, midway, half_width, v_s, k_t, f_v, dt;
    double x[1];
    /* The last velocity, the acceleration to it, and the direction of the slip; 0 while stuck. */
    double velocity, acceleration, slip;
};

static void wojewoda_start(struct wojewoda *m)
{
    double f_s = 0.0994, f_c = 0.0925, f_d = f_c;
    *m = (struct wojewoda){.f_s = f_s, .f_c = f_c, .v_s = 0.1407, .f_v = 0.0403, .dt = period};
    m->k_t = f_s * (PI / 2.0) / 0.006;
    m->midway = 0.5 * f_s + 0.5 * f_d - f_c;
    m->half_width = 0.5 * f_s - 0.5 * f_d;
}

/* How much of the branches' distance from F_c is left at this speed. */
static inline double wojewoda_level(const struct wojewoda *m, double v)
{
    return exp(-fabs(v) / m->v_s);
}

/* The most that the contact carries. */
static inline double wojewoda_most(const struct wojewoda *m, double v, double left)
{
    double faster = v < 0.0 ? -m->acceleration : m->acceleration;
    return m->slip == 0.0 ? m->f_s : m->f_c + (m->midway + sign(faster) * m->half_width) * left;
}

static inline void wojewoda_break_away(struct wojewoda *m, double z)
{
    if (m->slip == 0.0 && m->k_t * fabs(z) >= m->f_s)
        m->slip = sign(z);
}

static inline void wojewoda_sample(struct wojewoda *m, double v, double left, double dt)
{
    m->acceleration = (v - m->velocity) / dt;
    m->velocity = v;
    wojewoda_break_away(m, m->x[0]);
    if (v * m->slip <= 0.0)
        m->slip = 0.0;
    m->x[0] = saturate(wojewoda_most(m, v, left) / m->k_t, m->x[0]);
}

static inline double wojewoda_step(struct wojewoda *m, double v)
{
    v = bounded(v);
    double left = wojewoda_level(m, v);
    wojewoda_sample(m, v, left, m->dt);
    double z = m->x[0];
    double force = saturate(wojewoda_most(m, v, left), m->k_t * z) + m->f_v * v;
    z += v * m->dt;
    wojewoda_break_away(m, z);
    m->x[0] = saturate(m->f_s / m->k_t, z);
    return force;
}

static inline void wojewoda_rates(const struct wojewoda *m, const double *x, double v, double left, double *rates)
{
    double spring = m->k_t * x[0];
    int at_the_end = m->slip != 0.0 && spring * v > 0.0 && fabs(spring) >= wojewoda_most(m, v, left);
    rates[0] = at_the_end ? 0.0 : v;
}

static inline double wojewoda_arrive(struct wojewoda *m, double v, double left)
{
    wojewoda_sample(m, v, left, period);
    return saturate(wojewoda_most(m, v, left), m->k_t * m->x[0]) + m->f_v * v;
}

RK4(wojewoda, struct wojewoda, 1)
DYNAMIC(wojewoda, struct wojewoda)

/* ---- A pure delay: 32 intervals, straight in between ----------------------------------------------- */

#define INTERVALS 32
#define LENGTH (INTERVALS + 1)

struct delay_line {
    double delay, spacing, since, now;
    int newest;
    double samples[LENGTH];
};

static inline double toward(double a, double b, double fraction)
{
    return a + (b - a) * between(0.0, 1.0, fraction);
}

/* dt go by, in which the signal goes straight to `value`. */
static inline void delay_push(struct delay_line *d, double value, double dt)
{
    if (d->spacing > 0.0 && dt > 0.0) {
        double end = d->since + dt;
        int passed = (int)(end / d->spacing);
        d->since = between(0.0, d->spacing, end - passed * d->spacing);
        for (int later = (passed < LENGTH ? passed : LENGTH) - 1; later >= 0; later--) {
            double ago = later * d->spacing + d->since;
            d->newest = (d->newest + 1) % LENGTH;
            d->samples[d->newest] = toward(value, d->now, ago / dt);
        }
    }
    d->now = value;
}

static inline double delay_sample(const struct delay_line *d, int k)
{
    return d->samples[(d->newest + LENGTH - (k < INTERVALS ? k : INTERVALS)) % LENGTH];
}

/* The delayed signal `ahead` of now, to which it goes straight to `value`. */
static inline double delayed(const struct delay_line *d, double value, double ahead)
{
    double ago = d->delay - ahead;
    if (d->spacing == 0.0)
        return value;
    if (ago < 0.0)
        return toward(value, d->now, d->delay / ahead);
    if (ago <= d->since)
        return d->since > 0.0 ? toward(d->now, delay_sample(d, 0), ago / d->since) : d->now;
    double place = (ago - d->since) / d->spacing;
    int before = (int)place;
    return toward(delay_sample(d, before), delay_sample(d, before + 1), place - before);
}

/* ---- Armstrong-Helouvry, seven parameters ---------------------------------------------------------- */

struct armstrong {
    double f_s, f_c, v_s, k_t, gamma, f_v, dt;
    /* Deflection, and the time since the last sample. */
    double x[2];
    /* Direction of the slip, Stribeck friction of it, time stuck. */
    double slip, stribeck, dwell;
    struct delay_line past;
};

static void armstrong_start(struct armstrong *m)
{
    *m = (struct armstrong){.f_s = 0.0994, .f_c = 0.0925, .v_s = 0.1407, .gamma = 1.0, .f_v = 0.0403};
    m->k_t = m->f_s * (PI / 2.0) / 0.006;
    m->dt = period;
    m->stribeck = m->f_s - m->f_c;
    m->past.delay = 0.0111;
    m->past.spacing = m->past.delay / INTERVALS;
}

static inline double armstrong_risen(const struct armstrong *m, double ahead)
{
    double dwell = m->dwell + ahead;
    return m->stribeck + (m->f_s - m->f_c - m->stribeck) * (dwell / (dwell + m->gamma));
}

/* Of breakaway while stuck, of sliding in a slip. */
static inline double armstrong_most(const struct armstrong *m, double v, double ahead)
{
    if (m->slip == 0.0)
        return m->f_c + armstrong_risen(m, ahead);
    double r = delayed(&m->past, v, ahead) / m->v_s;
    return m->f_c + m->stribeck / (1.0 + r * r);
}

static inline void armstrong_advance(struct armstrong *m, double v, double elapsed)
{
    double x = m->x[0];
    int outward = m->past.now * x > 0.0 || v * x > 0.0;
    delay_push(&m->past, v, elapsed);
    if (m->slip == 0.0) {
        m->dwell += elapsed;
        double most = armstrong_most(m, v, 0.0);
        if (outward && m->k_t * fabs(x) >= most) {
            m->stribeck = armstrong_risen(m, 0.0);
            m->slip = sign(x);
            x = m->slip * most / m->k_t;
        }
    }
    if (m->slip != 0.0 && v * m->slip <= 0.0) {
        double most = armstrong_most(m, v, 0.0);
        x = m->slip * most / m->k_t;
        m->stribeck = most - m->f_c;
        m->slip = 0.0;
        m->dwell = 0.0;
    }
    m->x[0] = x;
    m->x[1] = 0.0;
}

static inline double armstrong_force(const struct armstrong *m, double v)
{
    double most = armstrong_most(m, v, m->x[1]);
    if (m->slip == 0.0)
        return saturate(most, m->k_t * m->x[0]);
    return m->slip * most + m->f_v * (v * m->slip > 0.0 ? v : 0.0);
}

static inline double armstrong_step(struct armstrong *m, double v)
{
    v = bounded(v);
    armstrong_advance(m, v, m->x[1]);
    double force = armstrong_force(m, v);
    if (m->slip == 0.0)
        m->x[0] += v * m->dt;
    m->x[1] = m->dt;
    return force;
}

static inline double armstrong_level(const struct armstrong *m, double v)
{
    (void)m, (void)v;
    return 0.0;
}

static inline void armstrong_rates(const struct armstrong *m, const double *x, double v, double none, double *rates)
{
    (void)x, (void)none;
    rates[0] = m->slip == 0.0 ? v : 0.0;
    rates[1] = 1.0;
}

static inline double armstrong_arrive(struct armstrong *m, double v, double none)
{
    (void)none;
    armstrong_advance(m, v, period);
    return armstrong_force(m, v);
}

RK4(armstrong, struct armstrong, 2)
DYNAMIC(armstrong, struct armstrong)
