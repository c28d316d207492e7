#include "furuta_on_board.h"
#include "loop.h"

#define TURN (LOOP_REAL)6.283185307179586

static loop_memory memory;
static bool begun;
static LOOP_REAL last_phi;
static LOOP_REAL phi_dot;

/* The largest integer that is not above a number of moderate size. */
static int32_t below(LOOP_REAL number) {
    const int32_t truncated = (int32_t)number;
    return truncated - (number < (LOOP_REAL)truncated ? 1 : 0);
}

static LOOP_REAL wrapped(LOOP_REAL angle) {
    return angle - TURN * (LOOP_REAL)below(angle / TURN + (LOOP_REAL)0.5);
}

/* The arm's speed by tachometer, or by the difference of its angles behind a low-pass filter. */
static LOOP_REAL arm_speed(LOOP_REAL phi, int16_t code) {
    if (LOOP_SPEED_SHARE > 0) {
        phi_dot += LOOP_SPEED_SHARE * ((phi - last_phi) / LOOP_SAMPLE_TIME - phi_dot);
        last_phi = phi;
        return phi_dot;
    }
    return ((LOOP_REAL)code - LOOP_SPEED_ZERO) * LOOP_SPEED_PER_CODE;
}

static int16_t drive_code(LOOP_REAL voltage) {
    const LOOP_REAL half = (LOOP_REAL)0.5;
    const int32_t code = below(voltage / LOOP_DRIVE_PER_CODE + LOOP_DRIVE_ZERO + half);
    if (code < LOOP_DRIVE_LOW) {
        return LOOP_DRIVE_LOW;
    }
    return code > LOOP_DRIVE_HIGH ? LOOP_DRIVE_HIGH : (int16_t)code;
}

struct furuta_frame furuta_answer(const struct furuta_sample *sample) {
    struct furuta_frame answer = {.type = FURUTA_DRIVE};
    loop_reading reading;
    loop_command command;
    reading.phi = ((LOOP_REAL)sample->arm - LOOP_ARM_ZERO) * LOOP_ARM_PER_CODE;
    if (!begun) {
        loop_init(&memory);
        last_phi = reading.phi;
        begun = true;
    }
    reading.phi_dot = arm_speed(reading.phi, sample->speed);
    reading.theta =
        wrapped(((LOOP_REAL)sample->pendulum - LOOP_PENDULUM_ZERO) * LOOP_PENDULUM_PER_CODE);
    reading.theta_dot = 0; /* no rig measures it */
    reading.torque = ((LOOP_REAL)sample->drive - LOOP_DRIVE_ZERO) * LOOP_DRIVE_PER_CODE;
    if ((sample->status & FURUTA_ARMED) == 0) {
        loop_forget_integrals(&memory);
    }
    loop_step(&memory, &reading, &command);
    answer.session = sample->session;
    answer.sample = sample->number;
    answer.code = drive_code(command.voltage);
    return answer;
}
