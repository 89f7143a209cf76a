/* A board, as the firmware sees it. Three parts that never meet otherwise:
 *
 *     sp_firmware.c   the scene           calls sp_port_*, sp_hand_*
 *     sp_port.c       periods             called by both, below
 *     sp_board_*.c    timer and start     implements sp_board_start
 *
 * sp_transducer.c is the sensor and the motor: replace it by your own.
 */
#ifndef SP_PORT_H
#define SP_PORT_H

#include <stdint.h>

/* For the main loop: the timer and interrupts on. */
void sp_port_start(float period_s);

/* Periods that have passed since the last call. */
uint32_t sp_port_take_elapsed_periods(void);

/* Until a period comes; returns at once where one has come. */
void sp_port_sleep(void);

/* For the board's timer. */
void sp_port_on_period(void);

/* Of the board: call sp_port_on_period() every period_s. */
void sp_board_start(float period_s);

/* Of the hand: before all else, the chip's clocks, sensor and motor; 1 and the newest position (m)
 * where the sensor has one, else 0; force (N) to the motor, positive out of the object. */
void sp_hand_start(void);
int sp_hand_motion(float *position_m);
void sp_hand_force(float force_n);

#endif
