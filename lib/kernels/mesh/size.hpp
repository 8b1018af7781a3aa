// How long mesh edges should be at a point: a background size, and sources around which it is smaller.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace restshape {

struct SizeSource {
    double x, y, size, reach;  // the size holds up to this distance, and grows from there on
};

// The least over the sources of size + growth (distance - reach), at most the background's.
class SizeField {
 public:
    SizeField(double background, double growth, std::vector<SizeSource> sources, const double* points,
              std::ptrdiff_t count)
        : background_(background), growth_(growth), sources_(std::move(sources)) {
        if (sources_.empty() || count == 0) return;
        double upper[2] = {points[0], points[1]};
        lower_[0] = points[0], lower_[1] = points[1];
        for (std::ptrdiff_t i = 0; i < 2 * count; ++i) {
            lower_[i % 2] = std::min(lower_[i % 2], points[i]);
            upper[i % 2] = std::max(upper[i % 2], points[i]);
        }
        const double wide = std::max(upper[0] - lower_[0], 1e-300), high = std::max(upper[1] - lower_[1], 1e-300);
        const double wanted = std::clamp<double>(static_cast<double>(sources_.size()), 16.0, 4096.0);
        side_ = std::max(std::sqrt(wide * high / wanted), std::max(wide, high) / 256.0);
        bins_[0] = static_cast<int>(wide / side_) + 1, bins_[1] = static_cast<int>(high / side_) + 1;
        near_.resize(static_cast<std::size_t>(bins_[0]) * bins_[1]);
        known_.assign(near_.size(), 0);
    }

    double at(double x, double y) const {
        if (sources_.empty()) return background_;
        const int i = bin(x, 0), j = bin(y, 1);
        const std::size_t bucket = static_cast<std::size_t>(j) * bins_[0] + i;
        if (!known_[bucket]) collect(bucket, i, j);
        double least = background_;
        for (const std::int32_t source : near_[bucket]) least = std::min(least, of(sources_[source], x, y));
        return least;
    }

    double background() const { return background_; }

    bool uniform() const { return sources_.empty(); }

 private:
    double of(const SizeSource& source, double x, double y) const {
        const double distance = std::sqrt((x - source.x) * (x - source.x) + (y - source.y) * (y - source.y));
        return source.size + growth_ * std::max(distance - source.reach, 0.0);
    }

    int bin(double value, int axis) const {
        return std::clamp(static_cast<int>((value - lower_[axis]) / side_), 0, bins_[axis] - 1);
    }

    // Sources that can be the least anywhere in a bucket; found when the bucket is first asked.
    void collect(std::size_t bucket, int i, int j) const {
        const double x = lower_[0] + (i + 0.5) * side_, y = lower_[1] + (j + 0.5) * side_;
        const double play = growth_ * side_ * 0.70710678118654757 * (1.0 + 1e-9);
        double least = background_;
        for (const SizeSource& source : sources_) least = std::min(least, of(source, x, y));
        const double limit = std::min(background_, least + play) + play;
        for (std::size_t k = 0; k < sources_.size(); ++k)
            if (of(sources_[k], x, y) < limit) near_[bucket].push_back(static_cast<std::int32_t>(k));
        known_[bucket] = 1;
    }

    double background_, growth_;
    std::vector<SizeSource> sources_;
    double lower_[2] = {0.0, 0.0}, side_ = 1.0;
    int bins_[2] = {1, 1};
    mutable std::vector<std::vector<std::int32_t>> near_;
    mutable std::vector<std::uint8_t> known_;
};

}  // namespace restshape
