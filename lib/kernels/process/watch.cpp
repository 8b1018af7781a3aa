#include "process/watch.hpp"

#include <fcntl.h>
#include <pybind11/pybind11.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>

namespace restshape {
namespace {

constexpr double LONGEST_TICK = 0.1;
constexpr int TICKS_A_FRAME = 5;
// Hundredths of a second in which the other process may finish.
constexpr int PATIENCE = 6000;

Limits limits;
Outlet outlet;
std::atomic<long> ticks{0}, most_ticks{0}, frame{0};
std::atomic<bool> ending{false};
long page_size = 4096;

// The text with the number of the frame in place of %d.
void say(const std::string& text) {
    char number[24], line[1024];
    int digits = 0, at = 0;
    long left = frame.load();
    do {
        number[digits++] = static_cast<char>('0' + left % 10);
        left /= 10;
    } while (left > 0 && digits < 20);
    for (std::size_t i = 0; i < text.size() && at < 1000; ++i) {
        if (text[i] == '%' && i + 1 < text.size() && text[i + 1] == 'd') {
            for (int k = digits; k > 0 && at < 1000;) line[at++] = number[--k];
            ++i;
        } else {
            line[at++] = text[i];
        }
    }
    [[maybe_unused]] ssize_t written = write(STDERR_FILENO, line, at);
}

void end(const std::string& text, char why) {
    // Meanwhile other threads get the timer's signal.
    if (ending.exchange(true)) return;
    say(text);
    if (outlet.control >= 0) {
        [[maybe_unused]] ssize_t written = write(outlet.control, &why, 1);
        close(outlet.control);
        const timespec pause{0, 10'000'000};
        for (int i = 0; i < PATIENCE && waitpid(outlet.process, nullptr, WNOHANG) == 0; ++i) nanosleep(&pause, nullptr);
    }
    _exit(limits.code);
}

// Resident memory [bytes]; 0 where the system does not report.
long long resident() {
    char text[128];
    const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0) return 0;
    const ssize_t length = read(file, text, sizeof text);
    close(file);
    ssize_t i = 0;
    while (i < length && text[i] != ' ') ++i;
    long long pages = 0;
    for (++i; i < length && text[i] >= '0' && text[i] <= '9'; ++i) pages = 10 * pages + (text[i] - '0');
    return pages * page_size;
}

void tick(int) {
    const int error = errno;
    if (most_ticks.load() > 0 && ++ticks > most_ticks.load()) end(limits.slow, 't');
    if (limits.bytes > 0 && resident() > limits.bytes) end(limits.large, 'm');
    errno = error;
}

void set_timer(double seconds) {
    timeval period{static_cast<time_t>(seconds), static_cast<suseconds_t>(1e6 * (seconds - std::floor(seconds)))};
    const itimerval timer{period, period};
    if (setitimer(ITIMER_REAL, &timer, nullptr)) throw std::runtime_error("no timer");
}

}  // namespace

void watch(const Limits& wanted) {
    stop_watching();
    limits = wanted;
    page_size = sysconf(_SC_PAGESIZE);
    ticks = 0, frame = 0;
    double period = LONGEST_TICK;
    if (limits.seconds > 0.0) period = std::clamp(limits.seconds / TICKS_A_FRAME, 1e-3, LONGEST_TICK);
    most_ticks = limits.seconds > 0.0 ? static_cast<long>(std::ceil(limits.seconds / period)) : 0;
    if (limits.seconds <= 0.0 && limits.bytes <= 0) return;
    struct sigaction action {};
    action.sa_handler = tick;
    action.sa_flags = SA_RESTART;
    sigaction(SIGALRM, &action, nullptr);
    set_timer(period);
    // A command may be done before the first tick.
    if (limits.bytes > 0 && resident() > limits.bytes) end(limits.large, 'm');
}

void set_outlet(const Outlet& wanted) { outlet = wanted; }

void begin_frame() {
    ticks = 0;
    ++frame;
}

void stop_watching() {
    set_timer(0.0);
    outlet = {};
}

}  // namespace restshape

namespace py = pybind11;
using namespace pybind11::literals;

void bind_watch(py::module_& m) {
    m.def(
        "watch",
        [](double seconds, long long bytes, int code, const std::string& slow, const std::string& large) {
            restshape::watch({seconds, bytes, code, slow, large});
        },
        "seconds"_a, "bytes"_a, "code"_a, "slow"_a, "large"_a,
        "From now on end the process with a code and a message where a frame takes longer [s] or resident memory is "
        "more [bytes]; 0: no limit. %d in a message stands for the number of the frame.");
    m.def(
        "watch_outlet",
        [](int control, int process) {
            restshape::set_outlet({control, process});
        },
        "control"_a, "process"_a,
        "Before such an end write 't' (time) or 'm' (memory) into a pipe, close it, and wait for a process.");
    m.def("begin_frame", &restshape::begin_frame, "The next frame begins: its time counts from now.");
    m.def("stop_watching", &restshape::stop_watching, "No limit holds any more.");
}
