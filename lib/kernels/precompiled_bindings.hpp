// clang-format off
#include "precompiled.hpp"
// Included before all else in each file that makes functions known to Python.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
