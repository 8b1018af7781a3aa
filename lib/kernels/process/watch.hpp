// Ends this process where a frame takes too long or memory runs out, also while compiled code does not return.
//
// A timer's signal counts ticks; its handler calls nothing but what signal handlers may call (signal-safety(7)). A
// process that is stopped for a while counts one tick for it, not the time. What counts is the time that a frame
// computes, so that other processes on the machine end none; one that waits is ended after a multiple of that.
#pragma once

#include <signal.h>
#include <sys/time.h>
#include <sys/types.h>

#include <stdexcept>
#include <string>

namespace restshape {

struct Limits {
    double seconds = 0.0;     // a frame may compute; 0: any time
    long long bytes = 0;      // of resident memory; 0: any
    int code = 3;             // with which the process ends
    std::string slow, large;  // messages, with places for what a frame has taken
    double waits = 10.0;      // times as long may it take by the clock
};

// Where the watched process hands its frames over: a pipe that wakes a process which finishes by itself.
struct Outlet {
    int control = -1;
    pid_t process = 0;
};

void watch(const Limits& limits);
void set_outlet(const Outlet& outlet);
void set_stage(const std::string& text);
void begin_frame();
void stop_watching();

}  // namespace restshape
