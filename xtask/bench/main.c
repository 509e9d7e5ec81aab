/* The friction models as a C programmer would write them: the peer of
 * friction_model/examples/step_bench.rs, for `cargo xtask bench`.
 *
 *     gcc -O3 -march=native *.c -lm && ./a.out 1000000 [MODEL ...]
 *
 * prints, for each model and scheme, the model's name, the scheme, nanoseconds a step and the sum of all
 * forces. The schemes: `exact`, the fixed-step form, and `rk4`, the derivative form under classical
 * Runge-Kutta, for models with states.
 */
#include <stdlib.h>
#include <string.h>

#include "peer.h"

double velocity[SAMPLES], period, gaussian;

#define MODELS(X)                                                                                      \
    X(coulomb) X(viscous) X(coulomb_viscous) X(stiction) X(stribeck) X(rate_dependent_stiction)        \
    X(karnopp) X(two_line) X(rbf_network) X(bengisu_akay) X(reset_integrator) X(dahl)                  \
    X(bliman_sorine) X(lugre) X(elasto_plastic) X(leuven) X(gms) X(xiong) X(proposed)                  \
    X(proposed_linear) X(wojewoda) X(armstrong) X(bristle)

#define DECLARE(model) void measure_##model(long steps);
MODELS(DECLARE)

#define ENTRY(model) {#model, measure_##model},
static const struct {
    const char *name;
    void (*measure)(long steps);
} models[] = {MODELS(ENTRY)};

static int wanted(const char *name, int count, char **names)
{
    for (int i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0)
            return 1;
    return count == 0;
}

int main(int argc, char **argv)
{
    long steps = argc > 1 ? atol(argv[1]) : 0;
    if (steps < 10) {
        fprintf(stderr, "usage: peer STEPS [MODEL ...] (at least 10 steps)\n");
        return 2;
    }
    for (int i = 0; i < SAMPLES; i++) {
        double phase = 2.0 * PI * (double)i / SAMPLES;
        velocity[i] = 0.02 + 0.2 * sin(3.0 * phase) + 0.01 * sin(41.0 * phase);
    }
    volatile double dt = 1e-3, two = 2.0;
    period = dt;
    gaussian = two;
    for (size_t i = 0; i < sizeof models / sizeof *models; i++)
        if (wanted(models[i].name, argc - 2, argv + 2))
            models[i].measure(steps);
    return 0;
}
