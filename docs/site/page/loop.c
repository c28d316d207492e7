/* The closed loop of the page: plant, sensors and control system, translated from Python. The page
 * writes into `design`, `noise` and the initial state, and reads `signals` after each sample. */
#include <stdbool.h>
#include <stdint.h>

#define NAN __builtin_nan("")
#define INFINITY __builtin_inf()
#define isnan(x) __builtin_isnan(x)
#define copysign __builtin_copysign
#define fabs __builtin_fabs
#define floor __builtin_floor
#define ceil __builtin_ceil
#define fma __builtin_fma
#define sqrt __builtin_sqrt
#define EXPORT(name) __attribute__((export_name(#name), visibility("default"))) name

static double design[@size@], noise[2], signals[14];

@constants@

@structures@

@functions@

static loop_plant_memory plant_memory;
static loop_control_memory control_memory;
static double applied;

double *EXPORT(design_address)(void) {
    return design;
}

double *EXPORT(noise_address)(void) {
    return noise;
}

/* x (5), estimate (5), friction, its estimate, command, samples. */
double *EXPORT(signals_address)(void) {
    return signals;
}

/* Puts the pendulum back, or begins for the first time: nothing is remembered. */
void EXPORT(begin)(double phi, double theta, bool forget) {
    const loop_plant_memory at_rest = {0};
    plant_memory = at_rest;
    plant_memory.x[0] = phi;
    plant_memory.x[2] = theta;
    applied = 0.0;
    if (forget) {
        const loop_control_memory zero = {0};
        control_memory = zero;
        loop_control_memory *memory = &control_memory;@initial@
    } else {
        @reset@(&control_memory);
    }
}

/* One sample with a friction law and a control system, each by its number. */
void EXPORT(sample)(int law, int control) {
    double measurement[5], friction_estimate = 0.0, command = 0.0, *estimate = signals + 5;
    @read@;
    measurement[4] = applied;
    switch (control) {
@controls@
    }
    for (int i = 0; i < 5; i++) {
        signals[i] = plant_memory.x[i];
    }
    signals[11] = friction_estimate;
    signals[12] = command;
    switch (law) {
@laws@
    }
    signals[13] = (double)plant_memory.moved;
}
