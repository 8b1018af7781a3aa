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
constexpr int STAGE = 400;
// Hundredths of a second in which the other process may finish.
constexpr int PATIENCE = 6000;

Limits limits;
Outlet outlet;
std::atomic<long> ticks{0}, most_ticks{0}, frame{0};
std::atomic<double> begun{0.0}, period{LONGEST_TICK};
char stage[STAGE];
std::atomic<int> stage_length{0};
std::atomic<bool> ending{false};
long page_size = 4096;

// Processor time that this process, with all its threads, has taken [s].
double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A line of some length to which a signal handler may add.
struct Line {
    char text[1600];
    int length = 0;

    void add(char one) {
        if (length < static_cast<int>(sizeof text)) text[length++] = one;
    }

    void add(long number) {
        char digits[24];
        int count = 0;
        do {
            digits[count++] = static_cast<char>('0' + number % 10);
            number /= 10;
        } while (number > 0 && count < 20);
        while (count > 0) add(digits[--count]);
    }

    // With one decimal.
    void add(double seconds) {
        const long tenths = std::lround(10.0 * seconds);
        add(tenths / 10), add('.'), add(tenths % 10);
    }
};

// The text with the number of the frame, its processor time, its time by the clock and its stage in place of %d, %p,
// %c and %s.
void say(const std::string& text) {
    Line line;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char next = text[i] == '%' && i + 1 < text.size() ? text[i + 1] : ' ';
        if (next == 'd') line.add(frame.load());
        if (next == 'p') line.add(processor_seconds() - begun.load());
        if (next == 'c') line.add(static_cast<double>(ticks.load()) * period.load());
        if (next == 's')
            for (int k = 0; k < stage_length.load(); ++k) line.add(stage[k]);
        if (next == 'd' || next == 'p' || next == 'c' || next == 's')
            ++i;
        else
            line.add(text[i]);
    }
    [[maybe_unused]] ssize_t written = write(STDERR_FILENO, line.text, line.length);
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

// Whether the frame has computed for longer than it may, or has come to no end for much longer by the clock.
bool too_long() {
    const long most = most_ticks.load();
    if (most <= 0 || ++ticks <= most) return false;
    return ticks.load() > limits.waits * most || processor_seconds() - begun.load() > limits.seconds;
}

void tick(int) {
    const int error = errno;
    if (too_long()) end(limits.slow, 't');
    if (limits.bytes > 0 && resident() > limits.bytes) end(limits.large, 'm');
    errno = error;
}

void set_timer(double seconds) {
    timeval tick{static_cast<time_t>(seconds), static_cast<suseconds_t>(1e6 * (seconds - std::floor(seconds)))};
    const itimerval timer{tick, tick};
    if (setitimer(ITIMER_REAL, &timer, nullptr)) throw std::runtime_error("no timer");
}

}  // namespace

void watch(const Limits& wanted) {
    stop_watching();
    limits = wanted;
    page_size = sysconf(_SC_PAGESIZE);
    ticks = 0, frame = 0, begun = processor_seconds(), period = LONGEST_TICK;
    if (limits.seconds > 0.0) period = std::clamp(limits.seconds / TICKS_A_FRAME, 1e-3, LONGEST_TICK);
    most_ticks = limits.seconds > 0.0 ? static_cast<long>(std::ceil(limits.seconds / period.load())) : 0;
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

void set_stage(const std::string& text) {
    // The handler may look at any time: it finds the old stage, none, or the new one.
    stage_length = 0;
    const int length = std::min(static_cast<int>(text.size()), STAGE);
    std::copy_n(text.begin(), length, stage);
    stage_length = length;
}

void begin_frame() {
    ticks = 0, begun = processor_seconds();
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
        [](double seconds, long long bytes, int code, const std::string& slow, const std::string& large, double waits) {
            restshape::watch({seconds, bytes, code, slow, large, waits});
        },
        "seconds"_a, "bytes"_a, "code"_a, "slow"_a, "large"_a, "waits"_a = 10.0,
        "From now on end the process with a code and a message where a frame computes longer (processor time of all "
        "threads, and as long by the clock) [s], takes `waits` times as long by the clock, or resident memory is more "
        "[bytes]; 0: no limit. %d, %p, %c and %s in a message stand for the number of the frame, its processor time "
        "[s], its time by the clock [s] and the stage.");
    m.def("set_stage", &restshape::set_stage, "stage"_a, "What is done from now on, for messages; empty: nothing.");
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
