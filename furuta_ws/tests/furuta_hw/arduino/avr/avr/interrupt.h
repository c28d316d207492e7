#define ISR_NOBLOCK
#define ISR(vector, attributes) \
    extern "C" void vector(); \
    extern "C" void vector() attributes
