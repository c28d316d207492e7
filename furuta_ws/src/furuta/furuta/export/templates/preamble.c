#if defined(__FAST_MATH__)
#error "compile without fast-math: NAN marks what is not known"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif

#if __STDC_HOSTED__
#include <math.h>
#else /* the compiler's own */
#define NAN __builtin_nanf("")
#define INFINITY __builtin_inff()
#define isnan(x) __builtin_isnan(x)
#define copysign@s@ __builtin_copysign@s@
#define fabs@s@ __builtin_fabs@s@
#define floor@s@ __builtin_floor@s@
#define fma@s@ __builtin_fma@s@
#define sqrt@s@ __builtin_sqrt@s@
#endif
