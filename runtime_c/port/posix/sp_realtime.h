/* What a thread asks the system for, and what it got: SP_GOT_ bits. */
#ifndef SP_REALTIME_H
#define SP_REALTIME_H

#include <stdint.h>

int32_t sp_realtime_request(int32_t priority, int32_t cpu);

#endif
