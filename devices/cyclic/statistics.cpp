#include "devices/cyclic/statistics.h"

#include <algorithm>
#include <cmath>

namespace seamwright {

void LatencyHistogram::record(std::int64_t latency_ns) {
    const std::int64_t ns = std::max<std::int64_t>(latency_ns, 0);
    buckets_[static_cast<std::size_t>(std::min<std::int64_t>(ns / kBucketNs, kBuckets))].fetch_add(
        1, std::memory_order_relaxed);
    if (ns > max_ns_.load(std::memory_order_relaxed)) max_ns_.store(ns, std::memory_order_relaxed);
    count_.fetch_add(1, std::memory_order_relaxed);
}

double LatencyHistogram::percentile_us(double q) const {
    std::uint64_t total = 0;
    for (const auto& bucket : buckets_) total += bucket;
    if (total == 0) return 0;
    const auto wanted =
        std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(total))));
    std::uint64_t seen = 0;
    for (int i = 0; i < kBuckets; ++i) {
        seen += buckets_[static_cast<std::size_t>(i)];
        if (seen >= wanted) return std::min((i + 1) * (kBucketNs / 1e3), max_us());
    }
    return max_us();
}

void LatencyHistogram::clear() {
    for (auto& bucket : buckets_) bucket = 0;
    count_ = 0;
    max_ns_ = 0;
}

}  // namespace seamwright
