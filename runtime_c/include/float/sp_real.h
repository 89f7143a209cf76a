#ifndef SP_REAL_H
#define SP_REAL_H

#include <float.h>
#include <math.h>

/* The number type of the scene. Its twin in include/double is the other choice. */
typedef float sp_real;

#define SP_REAL_MAX FLT_MAX

/* Instructions with every FPU: no library is called. */
#define sp_abs(x) fabsf(x)
#define sp_sqrt(x) sqrtf(x)

#endif
