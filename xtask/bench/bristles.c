/* Models with one or two bristles: Dahl and LuGre, their relatives and forerunners. */
#include <stdint.h>

#include "peer.h"

/* ---- Dahl ---------------------------------------------------------------------------------------- */

struct dahl {
    double sigma0, delta, f_v, z_c, inverse_z_c, dt;
    double x[1];
};

static void dahl_start(struct dahl *m)
{
    *m = (struct dahl){.sigma0 = 16.469, .delta = 0.5 * gaussian, .f_v = 0.0403, .dt = period};
    m->z_c = 0.0929 / m->sigma0;
    m->inverse_z_c = 1.0 / m->z_c;
}

static inline double dahl_step(struct dahl *m, double v)
{
    v = bounded(v);
    double z = m->x[0];
    double strain = fabs(v) * m->inverse_z_c * m->dt;
    double end = copysign(m->z_c, v);
    if (m->delta == 1.0) {
        m->x[0] = end + (z - end) * exp(-strain);
    } else if (v != 0.0) {
        double e = 1.0 - m->delta;
        double left = pow(1.0 - z / end, e) - e * strain;
        double w = left > 0.0 ? pow(left, 1.0 / e) : 0.0;
        m->x[0] = saturate(m->z_c, end * (1.0 - w));
    }
    return m->sigma0 * z + m->f_v * v;
}

static inline double dahl_level(const struct dahl *m, double v)
{
    return sign(v) * m->inverse_z_c;
}

static inline void dahl_rates(const struct dahl *m, const double *x, double v, double per_z, double *rates)
{
    double w = 1.0 - x[0] * per_z;
    rates[0] = m->delta == 1.0 ? v - v * per_z * x[0] : v * pow(fabs(w), m->delta) * sign(w);
}

static inline double dahl_arrive(struct dahl *m, double v, double per_z)
{
    (void)per_z;
    m->x[0] = saturate(m->z_c, m->x[0]);
    return m->sigma0 * m->x[0] + m->f_v * v;
}

RK4(dahl, struct dahl, 1)
DYNAMIC(dahl, struct dahl)

/* ---- LuGre, exact for a held velocity ------------------------------------------------------------ */

struct lugre {
    struct curve curve;
    double sigma0, sigma1, v_d, f_v, dt;
    double x[1];
};

static void lugre_start(struct lugre *m)
{
    *m = (struct lugre){.sigma0 = 16.469, .sigma1 = 0.2494, .f_v = 0.0403, .dt = period};
    m->curve = stribeck_curve(0.0994, 0.0929, 0.1407);
}

/* Falls with speed if v_d is above zero. */
static inline double lugre_damping(const struct lugre *m, double v)
{
    double r = v / m->v_d;
    return m->v_d > 0.0 ? m->sigma1 * exp(-r * r) : m->sigma1;
}

static inline double lugre_step(struct lugre *m, double v)
{
    v = bounded(v);
    double z = m->x[0];
    double g = level(&m->curve, v);
    double rate = m->sigma0 * fabs(v) / g;
    double z_steady = copysign(g / m->sigma0, v);
    m->x[0] = z_steady + (z - z_steady) * exp(-rate * m->dt);
    return m->sigma0 * z + lugre_damping(m, v) * (v - rate * z) + m->f_v * v;
}

static inline double lugre_level(const struct lugre *m, double v)
{
    return level(&m->curve, v);
}

static inline void lugre_rates(const struct lugre *m, const double *x, double v, double g, double *rates)
{
    rates[0] = v - m->sigma0 * fabs(v) * x[0] / g;
}

static inline double lugre_arrive(struct lugre *m, double v, double g)
{
    double rate;
    lugre_rates(m, m->x, v, g, &rate);
    return m->sigma0 * m->x[0] + lugre_damping(m, v) * rate + m->f_v * v;
}

RK4(lugre, struct lugre, 1)
DYNAMIC(lugre, struct lugre)

/* ---- Elasto-plastic ------------------------------------------------------------------------------ */

struct elasto_plastic {
    struct curve curve;
    double sigma0, sigma1, z_ba, f_v, dt;
    double x[1];
};

static void elasto_plastic_start(struct elasto_plastic *m)
{
    *m = (struct elasto_plastic){.sigma0 = 16.469, .sigma1 = 0.2494, .f_v = 0.0403, .dt = period};
    m->curve = stribeck_curve(0.0994, 0.0929, 0.1407);
    m->z_ba = 0.7 * 0.0929 / 16.469;
}

static inline double elasto_plastic_alpha(const struct elasto_plastic *m, double z, double v, double z_ss)
{
    double deflection = fabs(z);
    if (sign(v) != sign(z) || deflection <= m->z_ba)
        return 0.0;
    if (deflection >= z_ss)
        return 1.0;
    return 0.5 * sin(PI * (deflection - 0.5 * (z_ss + m->z_ba)) / (z_ss - m->z_ba)) + 0.5;
}

static inline double elasto_plastic_level(const struct elasto_plastic *m, double v)
{
    return level(&m->curve, v) / m->sigma0;
}

static inline double elasto_plastic_step(struct elasto_plastic *m, double v)
{
    v = bounded(v);
    double z = m->x[0];
    double z_ss = elasto_plastic_level(m, v);
    double rate = elasto_plastic_alpha(m, z, v, z_ss) * fabs(v) / z_ss;
    double next;
    if (rate > 0.0) {
        double end = v / rate;
        next = end + (z - end) * exp(-rate * m->dt);
    } else {
        next = z + v * m->dt;
    }
    double outward = sign(v);
    if (outward * next > z_ss && outward * z <= z_ss)
        next = outward * z_ss;
    m->x[0] = next;
    return m->sigma0 * z + m->sigma1 * (v - rate * z) + m->f_v * v;
}

static inline void elasto_plastic_rates(const struct elasto_plastic *m, const double *x, double v, double z_ss,
                                        double *rates)
{
    rates[0] = v - elasto_plastic_alpha(m, x[0], v, z_ss) * fabs(v) * x[0] / z_ss;
}

static inline double elasto_plastic_arrive(struct elasto_plastic *m, double v, double z_ss)
{
    double rate;
    elasto_plastic_rates(m, m->x, v, z_ss, &rate);
    return m->sigma0 * m->x[0] + m->sigma1 * rate + m->f_v * v;
}

RK4(elasto_plastic, struct elasto_plastic, 1)
DYNAMIC(elasto_plastic, struct elasto_plastic)

/* ---- Bliman and Sorine, second order ------------------------------------------------------------- */

struct bliman_sorine {
    double f_1, f_2, fast, slow, f_v, dt;
    double x[2];
};

static void bliman_sorine_start(struct bliman_sorine *m)
{
    double f_s = 0.0994, f_c = 0.0925, stiffness = 0.0994 * (PI / 2.0) / 0.006, excess = f_s - f_c;
    *m = (struct bliman_sorine){.f_v = 0.0403, .dt = period};
    m->f_2 = 2.0 * (excess + sqrt(excess * f_s));
    m->f_1 = f_c + m->f_2;
    double eps_f = (2.0 * m->f_1 - m->f_2) / stiffness;
    m->fast = 1.0 / (0.5 * eps_f);
    m->slow = 1.0 / eps_f;
}

static inline double bliman_sorine_step(struct bliman_sorine *m, double v)
{
    v = bounded(v);
    double end_1 = m->f_1 * sign(v), end_2 = -m->f_2 * sign(v);
    double x_1 = m->x[0], x_2 = m->x[1];
    double distance = fabs(v) * m->dt;
    if (distance > 0.0) {
        m->x[0] = end_1 + (x_1 - end_1) * exp(-distance * m->fast);
        m->x[1] = end_2 + (x_2 - end_2) * exp(-distance * m->slow);
    }
    return x_1 + x_2 + m->f_v * v;
}

static inline double bliman_sorine_level(const struct bliman_sorine *m, double v)
{
    (void)m;
    return sign(v);
}

static inline void bliman_sorine_rates(const struct bliman_sorine *m, const double *x, double v, double direction,
                                       double *rates)
{
    rates[0] = fabs(v) * m->fast * (m->f_1 * direction - x[0]);
    rates[1] = fabs(v) * m->slow * (-m->f_2 * direction - x[1]);
}

static inline double bliman_sorine_arrive(struct bliman_sorine *m, double v, double direction)
{
    (void)direction;
    m->x[0] = saturate(m->f_1, m->x[0]);
    m->x[1] = saturate(m->f_2, m->x[1]);
    return m->x[0] + m->x[1] + m->f_v * v;
}

RK4(bliman_sorine, struct bliman_sorine, 2)
DYNAMIC(bliman_sorine, struct bliman_sorine)

/* ---- Reset integrator ---------------------------------------------------------------------------- */

struct reset_integrator {
    double sigma0, sigma1, a, p_0, f_v, dt;
    double x[1];
};

static void reset_integrator_start(struct reset_integrator *m)
{
    *m = (struct reset_integrator){.sigma1 = 0.3213, .f_v = 0.0403, .dt = period};
    m->p_0 = 0.0994 / (0.0994 * (PI / 2.0) / 0.006);
    m->sigma0 = 0.0925 / m->p_0;
    m->a = 0.0994 / 0.0925 - 1.0;
}

static inline double reset_integrator_level(const struct reset_integrator *m, double v)
{
    (void)m, (void)v;
    return 0.0;
}

static inline void reset_integrator_rates(const struct reset_integrator *m, const double *x, double v, double none,
                                          double *rates)
{
    (void)none;
    int slides = (v > 0.0 && x[0] >= m->p_0) || (v < 0.0 && x[0] <= -m->p_0);
    rates[0] = slides ? 0.0 : v;
}

static inline double reset_integrator_force(const struct reset_integrator *m, double v)
{
    double rate, p = m->x[0];
    reset_integrator_rates(m, m->x, v, 0.0, &rate);
    double weight = fabs(p) < m->p_0 ? 1.0 + m->a : 1.0;
    return m->sigma0 * saturate(m->p_0, p) * weight + m->sigma1 * rate + m->f_v * v;
}

static inline double reset_integrator_step(struct reset_integrator *m, double v)
{
    v = bounded(v);
    double force = reset_integrator_force(m, v);
    m->x[0] = saturate(m->p_0, m->x[0] + v * m->dt);
    return force;
}

static inline double reset_integrator_arrive(struct reset_integrator *m, double v, double none)
{
    (void)none;
    m->x[0] = saturate(m->p_0, m->x[0]);
    return reset_integrator_force(m, v);
}

RK4(reset_integrator, struct reset_integrator, 1)
DYNAMIC(reset_integrator, struct reset_integrator)

/* ---- Haessig and Friedland's bristle model: bonds that snap and are made anew at random ------------- */

#define MOST_BONDS 128
#define MOST_SNAPS 64

/* PCG32, O'Neill's generator, seeded as Rust's rand_core seeds it from one number. */
struct pcg32 {
    uint64_t state, increment;
};

static inline uint32_t pcg32_output(uint64_t state)
{
    uint32_t rotation = (uint32_t)(state >> 59), shifted = (uint32_t)(((state >> 18) ^ state) >> 27);
    return shifted >> rotation | shifted << (-rotation & 31);
}

static inline uint32_t pcg32_next(struct pcg32 *random)
{
    uint64_t state = random->state;
    random->state = state * 6364136223846793005u + random->increment;
    return pcg32_output(state);
}

static struct pcg32 pcg32_seeded(uint64_t seed)
{
    uint64_t words[4];
    for (int i = 0; i < 4; i++) {
        seed = seed * 6364136223846793005u + 11634580027462260723u;
        words[i] = pcg32_output(seed);
    }
    struct pcg32 random = {.increment = words[2] | words[3] << 32 | 1};
    random.state = (words[0] | words[1] << 32) + random.increment;
    pcg32_next(&random);
    return random;
}

/* In (0, 1), neither end included. */
static inline double uniform(struct pcg32 *random)
{
    return (pcg32_next(random) + 0.5) * 0x1p-32;
}

struct bristle {
    double sigma0, end, f_v, dt;
    int bonds;
    double x[1];
    /* Travel in the present direction, extension of each bond. */
    double run, extension[MOST_BONDS];
    struct pcg32 random;
};

static void bristle_start(struct bristle *m)
{
    double stiffness = 0.0994 * (PI / 2.0) / 0.006;
    *m = (struct bristle){.bonds = 100, .f_v = 0.0403, .dt = period, .random = pcg32_seeded(1)};
    m->sigma0 = 2.0 * stiffness / m->bonds;
    m->end = 1.5 * 0.0925 / stiffness;
    for (int i = 0; i < m->bonds; i++)
        m->extension[i] = m->end * ((2.0 * i + 1.0 - m->bonds) / m->bonds);
}

static inline double bristle_force(const struct bristle *m, double v)
{
    double sum = 0.0;
    for (int i = 0; i < m->bonds; i++)
        sum += saturate(m->end, m->extension[i] + m->x[0]);
    return m->sigma0 * sum + m->f_v * v;
}

/* The extension of a bond after a travel forward, in which it snaps as often as it must. */
static inline double travelled(struct pcg32 *random, double end, double u, double travel)
{
    if (travel > 20.0 * end)
        return end * (2.0 * sqrt(uniform(random)) - 1.0);
    for (int i = 0; i < MOST_SNAPS; i++) {
        if (u + travel < end)
            return u + travel;
        travel -= end - u;
        u = end * (2.0 * uniform(random) - 1.0);
    }
    return u;
}

static inline void bristle_travel(struct bristle *m, double travel)
{
    m->x[0] = 0.0;
    if (travel == 0.0 || travel != travel)
        return;
    m->run = saturate(2.0 * m->end, (m->run * travel > 0.0 ? m->run : 0.0) + travel);
    double direction = sign(travel);
    for (int i = 0; i < m->bonds; i++)
        m->extension[i] =
            direction * travelled(&m->random, m->end, direction * m->extension[i], fabs(travel));
}

static inline double bristle_step(struct bristle *m, double v)
{
    v = bounded(v);
    double force = bristle_force(m, v);
    bristle_travel(m, m->x[0] + v * m->dt);
    return force;
}

static inline double bristle_level(const struct bristle *m, double v)
{
    (void)m, (void)v;
    return 0.0;
}

static inline void bristle_rates(const struct bristle *m, const double *x, double v, double none, double *rates)
{
    (void)m, (void)x, (void)none;
    rates[0] = v;
}

static inline double bristle_arrive(struct bristle *m, double v, double none)
{
    (void)none;
    bristle_travel(m, m->x[0]);
    return bristle_force(m, v);
}

RK4(bristle, struct bristle, 1)
DYNAMIC(bristle, struct bristle)
