#ifndef SP_REAL_H
#define SP_REAL_H

#include <float.h>
#include <math.h>

/* The number type of the scene. Its twin in include/float is the other choice. */
typedef double sp_real;

#define SP_REAL_MAX DBL_MAX

/* Instructions with every FPU: no library is called. */
#define sp_abs(x) fabs(x)
#define sp_sqrt(x) sqrt(x)

#endif
