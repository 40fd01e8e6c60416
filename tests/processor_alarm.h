// A limit on the processor time of a piece of work: a signal after seconds of this process's processor time, which
// other work on the machine does not use up.
#pragma once

#include <signal.h>
#include <sys/time.h>

enum { PROCESSOR_ALARM = SIGPROF };

// Raises PROCESSOR_ALARM after so many seconds of processor time from now; 0 seconds cancel it.
static inline void set_processor_alarm(unsigned seconds) {
  setitimer(ITIMER_PROF, &(struct itimerval){.it_value = {.tv_sec = (time_t)seconds}}, NULL);
}
