/* Frames of the serial protocol: COBS, CRC-32 and fields; docs/hardware.md has them as tables. */
#ifndef FURUTA_FRAMES_H
#define FURUTA_FRAMES_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FURUTA_VERSION 1u
/* No frame that is read is longer [bytes], without its closing zero. */
#define FURUTA_LONGEST_FRAME 64u
/* The longest frame that is written: Sensors, with the two bytes of COBS and the zero [bytes]. */
#define FURUTA_LONGEST_ANSWER 32u

enum furuta_type {
    FURUTA_HELLO = 0x01,
    FURUTA_DRIVE = 0x02,
    FURUTA_ARM = 0x03,
    FURUTA_STOP = 0x04,
    FURUTA_WELCOME = 0x81,
    FURUTA_SENSORS = 0x82
};

/* A frame from the host. Fields that its type does not have are unspecified. */
struct furuta_frame {
    uint32_t period_us;
    uint32_t sample;
    uint16_t session;
    uint16_t watchdog;
    int16_t code;
    uint8_t version;
    uint8_t type;
};

/* What a byte completes: nothing, a frame of the host, or bytes that are no such frame. */
enum furuta_found { FURUTA_NOTHING, FURUTA_FRAME, FURUTA_INVALID };

/* The bytes received since the last zero. All zero at the start. */
struct furuta_reader {
    uint8_t data[FURUTA_LONGEST_FRAME];
    uint8_t length;
    bool overlong;
};

/* The fields of a Sensors frame. */
struct furuta_sample {
    uint32_t number;
    uint32_t answered;
    int32_t arm;
    int32_t pendulum;
    uint16_t session;
    uint16_t discarded;
    int16_t speed;
    int16_t drive;
    uint8_t status;
};

/* Takes a byte from the line; fills in `frame` if the byte completes one. */
enum furuta_found furuta_read(struct furuta_reader *reader, uint8_t byte,
                              struct furuta_frame *frame);

/* Encode a frame with its closing zero; return its length [bytes]. */
uint8_t furuta_encode_welcome(uint8_t out[FURUTA_LONGEST_ANSWER], uint16_t session,
                              uint32_t period_us, uint16_t watchdog);
uint8_t furuta_encode_sensors(uint8_t out[FURUTA_LONGEST_ANSWER],
                              const struct furuta_sample *sample);

#ifdef __cplusplus
}
#endif

#endif
