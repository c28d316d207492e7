#include <stdint.h>
struct repeating_timer_t {
    void *user_data;
};
typedef bool (*repeating_timer_callback_t)(repeating_timer_t *timer);
bool add_repeating_timer_us(int64_t delay_us, repeating_timer_callback_t callback, void *user_data,
                            repeating_timer_t *out);
bool cancel_repeating_timer(repeating_timer_t *timer);
