#include "furuta_firmware.h"
#ifdef FURUTA_ON_BOARD
#include "furuta_on_board.h"
#endif

/* The interrupt changes these; outside of it they are used while it is locked. */
static struct furuta_rig rig;
static struct furuta_sample newest;
static bool unsent;
static bool ticked;

static struct furuta_reader reader;

struct furuta_rig *furuta_state(void) { return &rig; }

void furuta_setup(void) {
    const struct furuta_limits limits = board_limits();
    furuta_start(&rig, &limits);
    reader.length = 0;
    reader.overlong = false;
    unsent = false;
    ticked = false;
    board_drive(rig.code);
    board_start_timer(rig.period_us);
}

void furuta_tick(void) {
    newest.drive = rig.code;
    rig.fault = board_fault();
    furuta_advance(&rig);
    board_drive(rig.code);
    newest.arm = board_arm();
    newest.speed = board_speed();
    newest.pendulum = board_pendulum();
    newest.number = rig.number;
    newest.answered = rig.answered;
    newest.session = rig.session;
    newest.discarded = rig.discarded;
    newest.status = rig.status;
    unsent = rig.in_session;
    ticked = true;
#ifdef FURUTA_ON_BOARD
    const struct furuta_frame answer = furuta_answer(&newest);
    (void)furuta_execute(&rig, &answer); /* not while the rig is disarmed */
    board_drive(rig.code);
#endif
}

static bool take_newest(struct furuta_sample *sample) {
    board_lock();
    const bool due = unsent;
    if (due) {
        *sample = newest;
        unsent = false;
    }
    board_unlock();
    return due;
}

static void send_newest(void) {
    struct furuta_sample sample;
    uint8_t out[FURUTA_LONGEST_ANSWER];
    if (take_newest(&sample)) {
        board_write(out, furuta_encode_sensors(out, &sample));
    }
}

static void welcome(uint16_t session) {
    uint8_t out[FURUTA_LONGEST_ANSWER];
    board_write(out, furuta_encode_welcome(out, session, rig.period_us, rig.watchdog));
}

static void execute(const struct furuta_frame *frame) {
#ifdef FURUTA_ON_BOARD
    if (frame->type == FURUTA_DRIVE) {
        return; /* the board answers its samples itself */
    }
#endif
    const bool hello = frame->type == FURUTA_HELLO;
    board_lock();
    const uint32_t period_us = rig.period_us;
    rig.fault = board_fault();
    if (!furuta_execute(&rig, frame)) {
        rig.discarded++;
    }
    board_drive(rig.code);
    if (hello) {
        unsent = false; /* a sample of the session before */
    }
    board_unlock();
    if (hello) {
        if (rig.period_us != period_us) {
            board_start_timer(rig.period_us);
        }
        welcome(frame->session);
    }
}

static void discard(void) {
    board_lock();
    rig.discarded++;
    board_unlock();
}

static void receive(uint8_t byte) {
    struct furuta_frame frame;
    switch (furuta_read(&reader, byte, &frame)) {
    case FURUTA_FRAME:
        execute(&frame);
        break;
    case FURUTA_INVALID:
        discard();
        break;
    case FURUTA_NOTHING:
        break;
    }
}

/* Fed only while samples are taken and this loop runs: if one of them stops, so does the rig. */
static void feed_watchdog(void) {
    board_lock();
    const bool alive = ticked;
    ticked = false;
    board_unlock();
    if (alive) {
        board_feed_watchdog();
    }
}

void furuta_poll(void) {
    send_newest();
    const int byte = board_read();
    if (byte >= 0) {
        receive((uint8_t)byte);
    }
    feed_watchdog();
}
