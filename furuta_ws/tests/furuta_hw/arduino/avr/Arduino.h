/* Stand-in for the Arduino core and the registers of the ATmega328P. */
#include "arduino_common.h"

#define F_CPU 16000000UL
#define _BV(bit) (1 << (bit))

extern volatile uint8_t TCCR1A, TCCR1B, TCCR2A, TCCR2B, OCR2A, TIMSK1, TIFR1, ADMUX, ADCSRA, ADCSRB;
extern volatile uint16_t OCR1A, TCNT1, ADC;
enum { COM2A1 = 7, WGM20 = 0, CS20 = 0, WGM12 = 3, CS11 = 1, OCF1A = 1, OCIE1A = 1, REFS0 = 6 };
enum { ADEN = 7, ADSC = 6, ADATE = 5, ADPS2 = 2, ADPS1 = 1, ADPS0 = 0 };
