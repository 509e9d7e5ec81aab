/* Models of several elements side by side: GMS and Xiong's, with four. */
#include "peer.h"

#define ELEMENTS 4

/* ---- Generalised Maxwell-slip -------------------------------------------------------------------- */

struct gms {
    struct curve curve;
    double f_v, dt;
    double sigma0[ELEMENTS], sigma1[ELEMENTS], c[ELEMENTS];
    /* alpha / sigma0 and its inverse. */
    double width[ELEMENTS], inverse_width[ELEMENTS];
    double x[ELEMENTS];
    /* Direction in which an element slips; 0 while it sticks. */
    double slips[ELEMENTS];
};

static void gms_start(struct gms *m)
{
    static const double alpha[] = {0.2841, 0.2341, 0.2341, 0.2341};
    static const double sigma0[] = {7.9605, 4.8757, 2.6039, 1.0290};
    static const double sigma1[] = {0.1611, 0.1173, 0.0749, 0.0321};
    double sum = 0.2841 + 3.0 * 0.2341;
    *m = (struct gms){.curve = stribeck_curve(0.1035, 0.0921, 0.1), .f_v = 0.0403, .dt = period};
    for (int i = 0; i < ELEMENTS; i++) {
        double share = alpha[i] / sum;
        m->sigma0[i] = sigma0[i];
        m->sigma1[i] = sigma1[i];
        m->c[i] = 0.2998;
        m->width[i] = share / sigma0[i];
        m->inverse_width[i] = sigma0[i] / share;
    }
}

static inline double gms_level(const struct gms *m, double v)
{
    return level(&m->curve, v);
}

static inline double gms_step(struct gms *restrict m, double v)
{
    v = bounded(v);
    double g = level(&m->curve, v), inverse_g = 1.0 / g, direction = sign(v);
    double force = m->f_v * v;
    for (int i = 0; i < ELEMENTS; i++) {
        double z = m->x[i];
        if (m->slips[i] * direction > 0.0) {
            double relaxation = m->c[i] * m->inverse_width[i] * inverse_g;
            double rest = direction * m->width[i] * g;
            force += m->sigma0[i] * z + m->sigma1[i] * (m->c[i] * direction - relaxation * z);
            m->x[i] = rest + (z - rest) * exp(-relaxation * m->dt);
        } else {
            force += m->sigma0[i] * z + m->sigma1[i] * v;
            z += v * m->dt;
            double width = m->width[i] * g;
            int slides = direction != 0.0 && direction * z >= width;
            m->slips[i] = slides ? direction : 0.0;
            m->x[i] = slides ? direction * width : z;
        }
    }
    return force;
}

static inline void gms_rates(const struct gms *m, const double *x, double v, double g, double *rates)
{
    double inverse_g = 1.0 / g, direction = sign(v);
    for (int i = 0; i < ELEMENTS; i++) {
        double slip = m->c[i] * (direction - x[i] * m->inverse_width[i] * inverse_g);
        rates[i] = m->slips[i] * direction > 0.0 ? slip : v;
    }
}

static inline double gms_arrive(struct gms *restrict m, double v, double g)
{
    double direction = sign(v), rates[ELEMENTS];
    for (int i = 0; i < ELEMENTS; i++) {
        double width = m->width[i] * g;
        if (m->slips[i] != 0.0) {
            m->slips[i] = m->slips[i] == direction ? direction : 0.0;
        } else if (direction != 0.0 && direction * m->x[i] >= width) {
            m->slips[i] = direction;
            m->x[i] = direction * width;
        }
    }
    gms_rates(m, m->x, v, g, rates);
    double force = m->f_v * v;
    for (int i = 0; i < ELEMENTS; i++)
        force += m->sigma0[i] * m->x[i] + m->sigma1[i] * rates[i];
    return force;
}

RK4(gms, struct gms, ELEMENTS)
DYNAMIC(gms, struct gms)

/* ---- Xiong, Kikuuwe and Yamamoto ----------------------------------------------------------------- */

struct xiong {
    struct curve curve;
    double tau, f_v, dt, gamma_decay;
    double lambda[ELEMENTS], k[ELEMENTS], sigma[ELEMENTS], inverse_sigma[ELEMENTS], implicit_gain[ELEMENTS];
    /* z of each element, then gamma. */
    double x[ELEMENTS + 1];
};

static void xiong_start(struct xiong *m)
{
    static const double lambda[] = {0.2998, 0.2998, 0.2998, 0.1005};
    static const double k[] = {10.9915, 2.7836, 1.9866, 0.7792};
    static const double sigma[] = {0.1964, 0.0788, 0.0603, 0.0227};
    double sum = 3.0 * 0.2998 + 0.1005;
    *m = (struct xiong){.curve = stribeck_curve(0.10057, 0.0924, 0.13121), .tau = 0.0124, .f_v = 0.0403};
    m->dt = period;
    m->gamma_decay = exp(-m->dt / m->tau);
    for (int i = 0; i < ELEMENTS; i++) {
        m->lambda[i] = lambda[i] / sum;
        m->k[i] = k[i];
        m->sigma[i] = sigma[i];
        m->inverse_sigma[i] = 1.0 / sigma[i];
        m->implicit_gain[i] = 1.0 / (sigma[i] + k[i] * m->dt);
    }
    m->x[ELEMENTS] = m->curve.f_s;
}

static inline double xiong_level(const struct xiong *m, double v)
{
    return level(&m->curve, v);
}

static inline double xiong_step(struct xiong *restrict m, double v)
{
    v = bounded(v);
    double g = level(&m->curve, v), gamma = m->x[ELEMENTS];
    double force = m->f_v * v;
    for (int i = 0; i < ELEMENTS; i++) {
        double most = m->lambda[i] * gamma, elastic = m->k[i] * m->x[i], gain = m->implicit_gain[i];
        force += saturate(most, elastic + m->sigma[i] * v);
        m->x[i] += m->dt * between((-most - elastic) * gain, (most - elastic) * gain, v);
    }
    m->x[ELEMENTS] = g + (gamma - g) * m->gamma_decay;
    return force;
}

static inline void xiong_rates(const struct xiong *m, const double *x, double v, double g, double *rates)
{
    double gamma = x[ELEMENTS];
    for (int i = 0; i < ELEMENTS; i++) {
        double elastic = m->k[i] * x[i];
        double contact = saturate(m->lambda[i] * gamma, elastic + m->sigma[i] * v);
        rates[i] = (contact - elastic) * m->inverse_sigma[i];
    }
    rates[ELEMENTS] = (g - gamma) / m->tau;
}

static inline double xiong_arrive(struct xiong *restrict m, double v, double g)
{
    (void)g;
    double gamma = between(m->curve.f_c, m->curve.f_s, m->x[ELEMENTS]), force = m->f_v * v;
    m->x[ELEMENTS] = gamma;
    for (int i = 0; i < ELEMENTS; i++)
        force += saturate(m->lambda[i] * gamma, m->k[i] * m->x[i] + m->sigma[i] * v);
    return force;
}

RK4(xiong, struct xiong, ELEMENTS + 1)
DYNAMIC(xiong, struct xiong)
