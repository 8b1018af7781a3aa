// The laws of contacts.
#pragma once

namespace restshape::planks {

// How a contact acts: as springs that also pull, one-sided with Coulomb's friction, or one-sided with a friction that
// has a bound of its own, whatever the pressure: such contacts have an energy, and it is convex.
enum class Law { bilateral = 0, unilateral = 1, bounded = 2 };

}  // namespace restshape::planks
