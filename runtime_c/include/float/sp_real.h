#ifndef SP_REAL_H
#define SP_REAL_H

#include <math.h>

/* The number type of the scene. Its twin in include/double is the other choice. */
typedef float sp_real;

#define sp_sqrt(x) sqrtf(x)

#endif
