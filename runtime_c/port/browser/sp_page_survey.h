/* How stiff an object is where: presses of a scene with a map, for a page's picture of it. */
#ifndef SP_PAGE_SURVEY_H
#define SP_PAGE_SURVEY_H

#include <stdint.h>

/* As many places as a survey may have. */
uint32_t sp_page_survey_cells(void);

/* The first place and the last one: x, y, x, y, m. */
double *sp_page_survey_ends_m(void);

/* Press a fresh object at each place of a grid, columns x rows between the ends, to depth_m within
 * `ticks` of dt_s. Returns the forces at the end, N, row after row. */
const double *sp_page_survey(uint32_t columns, uint32_t rows, double depth_m, uint32_t ticks,
                             double dt_s);

#endif
