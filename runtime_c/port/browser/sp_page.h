/* A scene for a page in a browser: in closed loop with a simulated hand, or the frames of one that
 * runs elsewhere. The page calls these functions and reads and writes the module's one set of
 * buffers: rows of a tick each, at most sp_page_rows() of them, and bytes of a link.
 */
#ifndef SP_PAGE_H
#define SP_PAGE_H

#include <stdint.h>

#include "sp_real.h"

enum { SP_PAGE_MAX_DELAY = 176 };

/* Buffers. */
uint32_t sp_page_rows(void);
double *sp_page_intended_m(void);
sp_real *sp_page_position_m(void);
sp_real *sp_page_velocity_mps(void);
sp_real *sp_page_force_n(void);
int32_t *sp_page_notes(void);
uint32_t sp_page_link_bytes(void);
uint8_t *sp_page_link(void);

/* The device that the hand holds; at first the assumed one. Returns 0, or 1: nothing has changed.
 */
int sp_page_device(double mass_kg, double viscous_nspm, double coulomb_n);

/* The hand, and how many samples late the force acts. Returns 0, or 1: nothing has changed. */
int sp_page_hold(double mass_kg, double stiffness_npm, double damping_nspm, uint32_t delay_samples);

/* A fresh scene, and the hand at rest at position_m. */
void sp_page_start(double position_m);

/* `rows` ticks of dt_s towards intended_m of each; position, force and notes come out of it. */
void sp_page_press(uint32_t rows, double dt_s);

/* A fresh scene beside the pressed one, on rows of position_m and velocity_mps; force and notes
 * come out of it. */
void sp_page_replay(uint32_t rows);

/* CRC-32C of the bits of so many forces. */
uint32_t sp_page_force_crc(uint32_t rows);

/* Rows out of so many bytes of the link: calls of a scene that runs elsewhere. */
uint32_t sp_page_receive(uint32_t bytes);

/* Manifest hash of the scene that the other end renders, after its hello; null before. */
const uint8_t *sp_page_other_hash(void);

/* Bytes of a frame for the other end, left at sp_page_link(). */
uint32_t sp_page_ask(void);
uint32_t sp_page_command(uint32_t action, float watchdog_s, float rate_hz);

#endif
