// Ends this process where a frame takes too long or memory runs out, also while compiled code does not return.
//
// A timer's signal counts ticks; its handler calls nothing but what signal handlers may call (signal-safety(7)). A
// process that is stopped for a while counts one tick for it, not the time.
#pragma once

#include <signal.h>
#include <sys/time.h>
#include <sys/types.h>

#include <stdexcept>
#include <string>

namespace restshape {

struct Limits {
    double seconds = 0.0;     // a frame may take; 0: any time
    long long bytes = 0;      // of resident memory; 0: any
    int code = 3;             // with which the process ends
    std::string slow, large;  // messages; %d is replaced by the number of the frame
};

// Where the watched process hands its frames over: a pipe that wakes a process which finishes by itself.
struct Outlet {
    int control = -1;
    pid_t process = 0;
};

void watch(const Limits& limits);
void set_outlet(const Outlet& outlet);
void begin_frame();
void stop_watching();

}  // namespace restshape
