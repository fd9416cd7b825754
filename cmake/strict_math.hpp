// Included before every source by pliant::settings: refuses flags that would change the bits of a
// state or disable checks for NaN. SPEC 10.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error \
    "pliant gives the same bits everywhere: build it without -ffast-math and the flags it stands for"
#endif
