/* Models whose force depends on the velocity alone. */
#include "peer.h"

struct coulomb {
    double f_c;
};

static void coulomb_start(struct coulomb *m) { *m = (struct coulomb){.f_c = 0.0925}; }

static inline double coulomb_step(const struct coulomb *m, double v) { return m->f_c * sign(bounded(v)); }

MEMORYLESS(coulomb, struct coulomb)

struct viscous {
    double f_v;
};

static void viscous_start(struct viscous *m) { *m = (struct viscous){.f_v = 0.0403}; }

static inline double viscous_step(const struct viscous *m, double v) { return m->f_v * bounded(v); }

MEMORYLESS(viscous, struct viscous)

struct coulomb_viscous {
    double f_c, f_v;
};

static void coulomb_viscous_start(struct coulomb_viscous *m)
{
    *m = (struct coulomb_viscous){.f_c = 0.0925, .f_v = 0.0403};
}

static inline double coulomb_viscous_step(const struct coulomb_viscous *m, double v)
{
    v = bounded(v);
    return m->f_c * sign(v) + m->f_v * v;
}

MEMORYLESS(coulomb_viscous, struct coulomb_viscous)

/* Stiction with a constant and with a rate-dependent level differ in how they hold, not in how they slide. */
struct stiction {
    double f_s, f_c, f_v;
};

static void stiction_start(struct stiction *m)
{
    *m = (struct stiction){.f_s = 0.0994, .f_c = 0.0925, .f_v = 0.0403};
}

static inline double stiction_step(const struct stiction *m, double v)
{
    v = bounded(v);
    return m->f_c * sign(v) + m->f_v * v;
}

MEMORYLESS(stiction, struct stiction)

struct rate_dependent_stiction {
    double f_c, f_v;
    struct curve breakaway;
};

static void rate_dependent_stiction_start(struct rate_dependent_stiction *m)
{
    *m = (struct rate_dependent_stiction){.f_c = 0.0925, .f_v = 0.0403};
    m->breakaway = stribeck_curve(0.0994, 0.0925, 0.0066);
}

static inline double rate_dependent_stiction_step(const struct rate_dependent_stiction *m, double v)
{
    v = bounded(v);
    return m->f_c * sign(v) + m->f_v * v;
}

MEMORYLESS(rate_dependent_stiction, struct rate_dependent_stiction)

struct stribeck {
    struct curve curve;
    double f_v;
};

static void stribeck_start(struct stribeck *m)
{
    *m = (struct stribeck){.curve = stribeck_curve(0.0994, 0.0925, 0.1407), .f_v = 0.0403};
}

static inline double stribeck_step(const struct stribeck *m, double v)
{
    v = bounded(v);
    return sign(v) * level(&m->curve, v) + m->f_v * v;
}

MEMORYLESS(stribeck, struct stribeck)

struct karnopp {
    struct curve curve;
    double d_v, f_v;
};

static void karnopp_start(struct karnopp *m)
{
    *m = (struct karnopp){.curve = stribeck_curve(0.0994, 0.0925, 0.1407), .d_v = 1e-3, .f_v = 0.0403};
}

static inline double karnopp_step(const struct karnopp *m, double v)
{
    v = bounded(v);
    if (fabs(v) <= m->d_v)
        return 0.0;
    return sign(v) * level(&m->curve, v) + m->f_v * v;
}

MEMORYLESS(karnopp, struct karnopp)

struct two_line {
    double a1, b1, a2, b2, switch_speed;
};

static void two_line_start(struct two_line *m)
{
    *m = (struct two_line){.a1 = 0.0994, .b1 = 0.0403 - 0.0069 / 0.1407, .a2 = 0.0925, .b2 = 0.0403};
    m->switch_speed = (m->a1 - m->a2) / (m->b2 - m->b1);
}

static inline double two_line_step(const struct two_line *m, double v)
{
    v = bounded(v);
    int first = fabs(v) <= m->switch_speed;
    return (first ? m->a1 : m->a2) * sign(v) + (first ? m->b1 : m->b2) * v;
}

MEMORYLESS(two_line, struct two_line)

#define MOST_BELLS 32

struct rbf_network {
    int bells;
    double w0, weight[MOST_BELLS], centre[MOST_BELLS], inverse_width[MOST_BELLS];
};

static void rbf_network_start(struct rbf_network *m)
{
    static const double weight[] = {
        -0.112960839812,  0.017753751056,  -0.043246133603,  -0.0442151002617, -0.0515929315715,
        -0.0528600634885, -0.060075609887, -0.0564031150168, -0.0789119771417, -0.00334031266961,
    };
    static const double centre[] = {
        0.0,          0.05,           0.0864681670102, 0.149534878122, 0.258600136306,
        0.4472135955, 0.773394797299, 1.33748060995,   2.31298993509,  4.0,
    };
    static const double width[] = {
        0.05,           0.0432340835051, 0.0497674390611, 0.086065984648, 0.148839358689,
        0.257397330496, 0.445133507226,  0.769797568894,  1.33125969502,  1.68701006491,
    };
    *m = (struct rbf_network){.bells = 10, .w0 = 0.291279804329};
    for (int i = 0; i < m->bells; i++) {
        m->weight[i] = weight[i];
        m->centre[i] = centre[i];
        m->inverse_width[i] = 1.0 / width[i];
    }
}

static inline double rbf_network_step(const struct rbf_network *m, double v)
{
    v = bounded(v);
    double speed = fabs(v), sum = m->w0;
    for (int i = 0; i < m->bells; i++) {
        double r = (speed - m->centre[i]) * m->inverse_width[i];
        sum += m->weight[i] * exp(-0.5 * r * r);
    }
    return sign(v) * (sum > 0.0 ? sum : 0.0);
}

MEMORYLESS(rbf_network, struct rbf_network)

struct bengisu_akay {
    double f_s, f_c, v_0, xi, f_v;
};

static void bengisu_akay_start(struct bengisu_akay *m)
{
    *m = (struct bengisu_akay){
        .f_s = 0.0994, .f_c = 0.0925, .v_0 = 0.01407, .xi = 1.0 / 0.1407, .f_v = 0.0403};
}

static inline double bengisu_akay_step(const struct bengisu_akay *m, double v)
{
    v = bounded(v);
    double speed = fabs(v), force;
    if (speed <= m->v_0) {
        double below = speed / m->v_0 - 1.0;
        force = m->f_s * (1.0 - below * below);
    } else {
        force = m->f_c + (m->f_s - m->f_c) * exp(-m->xi * (speed - m->v_0));
    }
    return sign(v) * force + m->f_v * v;
}

MEMORYLESS(bengisu_akay, struct bengisu_akay)
