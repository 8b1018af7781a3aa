// How often each kernel has been called, and on how many elements: one addition a call, none an element.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace restshape {

enum class Purpose { residual, tangent, energy, stress, design, field };

constexpr std::array<const char*, 6> purpose_names = {"residual", "tangent", "energy", "stress", "design", "field"};

struct Tally {
    struct Count {
        int64_t calls = 0, elements = 0;
    };
    std::array<Count, purpose_names.size()> counts;

    void add(Purpose purpose, int64_t elements) {
        Count& count = counts[static_cast<size_t>(purpose)];
        ++count.calls;
        count.elements += elements;
    }
};

// By the kernel's name; entries stay where they are.
std::map<std::string, Tally>& tallies();

}  // namespace restshape
