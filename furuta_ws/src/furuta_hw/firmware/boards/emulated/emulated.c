/* A board in the memory of a computer: replays a script of bytes and samples, and logs bytes and
   state. Tests and the emulated rig run it.

   A script is a series of operations, little-endian:

       'b' limits as in power_on()                          power-on
       'r' fault u8, size u16, bytes                        bytes from the host
       's' fault u8, arm i32, speed i16, pendulum i32       a sample
       'n' number u32, answered u32                         sets the sample numbers

   The log has for each: size u16, bytes for the host, and the state as in put_state(). */

#include "furuta_firmware.h"

static const uint8_t *script;
static const uint8_t *unread;
static const uint8_t *unread_end;
static uint8_t *log_end;
static struct furuta_limits limits;
static int32_t arm_code;
static int16_t speed_code;
static int32_t pendulum_code;
static int16_t drive_code;
static bool fault;

/* Replays a script; returns the size of the log, which is at most 64 times that of the script. */
uint32_t emulated_replay(const uint8_t *begin, uint32_t size, uint8_t *log);

struct furuta_limits board_limits(void) { return limits; }

int board_read(void) { return unread < unread_end ? *unread++ : -1; }

void board_write(const uint8_t *data, uint8_t length) {
    for (uint8_t i = 0; i < length; i++) {
        *log_end++ = data[i];
    }
}

int32_t board_arm(void) { return arm_code; }
int16_t board_speed(void) { return speed_code; }
int32_t board_pendulum(void) { return pendulum_code; }
bool board_fault(void) { return fault; }
void board_drive(int16_t code) { drive_code = code; }
void board_start_timer(uint32_t period_us) { (void)period_us; }
void board_lock(void) {}
void board_unlock(void) {}
void board_feed_watchdog(void) {}

static uint8_t take_u8(void) { return *script++; }

static uint16_t take_u16(void) {
    const uint16_t low = take_u8();
    return (uint16_t)(low | ((uint16_t)take_u8() << 8));
}

static uint32_t take_u32(void) {
    const uint32_t low = take_u16();
    return low | ((uint32_t)take_u16() << 16);
}

static void put_u8(uint8_t value) { *log_end++ = value; }

static void put_u16(uint16_t value) {
    put_u8((uint8_t)(value & 0xffu));
    put_u8((uint8_t)(value >> 8));
}

static void put_u32(uint32_t value) {
    put_u16((uint16_t)(value & 0xffffu));
    put_u16((uint16_t)(value >> 16));
}

static void put_state(const struct furuta_rig *rig) {
    put_u32(rig->number);
    put_u32(rig->answered);
    put_u32(rig->driven);
    put_u32(rig->period_us);
    put_u16(rig->session);
    put_u16(rig->watchdog);
    put_u16(rig->discarded);
    put_u16((uint16_t)rig->code);
    put_u16((uint16_t)drive_code);
    put_u8(rig->status);
    put_u8(rig->in_session);
}

static void power_on(void) {
    limits.lowest_code = (int16_t)take_u16();
    limits.highest_code = (int16_t)take_u16();
    limits.zero_code = (int16_t)take_u16();
    limits.shortest_period_us = take_u32();
    limits.longest_period_us = take_u32();
    limits.longest_watchdog = take_u16();
    furuta_setup();
}

static void receive(void) {
    fault = take_u8() != 0;
    const uint16_t size = take_u16();
    unread = script;
    unread_end = script + size;
    script += size;
    while (unread < unread_end) {
        furuta_poll();
    }
}

static void sample(void) {
    fault = take_u8() != 0;
    arm_code = (int32_t)take_u32();
    speed_code = (int16_t)take_u16();
    pendulum_code = (int32_t)take_u32();
    furuta_tick();
    furuta_poll();
}

static void set_numbers(void) {
    furuta_state()->number = take_u32();
    furuta_state()->answered = take_u32();
}

static void run(uint8_t operation) {
    switch (operation) {
    case 'b':
        power_on();
        break;
    case 'r':
        receive();
        break;
    case 's':
        sample();
        break;
    default:
        set_numbers();
        break;
    }
}

uint32_t emulated_replay(const uint8_t *begin, uint32_t size, uint8_t *log) {
    script = begin;
    log_end = log;
    while (script < begin + size) {
        uint8_t *const head = log_end;
        log_end += 2;
        run(take_u8());
        const uint16_t written = (uint16_t)(log_end - head - 2);
        head[0] = (uint8_t)(written & 0xffu);
        head[1] = (uint8_t)(written >> 8);
        put_state(furuta_state());
    }
    return (uint32_t)(log_end - log);
}
