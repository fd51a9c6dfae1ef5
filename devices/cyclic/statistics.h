#pragma once
// Latencies of a cyclic answer, counted in fixed buckets: recording never allocates and never locks.

#include <array>
#include <atomic>
#include <cstdint>

namespace seamwright {

class LatencyHistogram {
  public:
    void record(std::int64_t latency_ns);
    std::uint64_t count() const { return count_; }
    double max_us() const { return static_cast<double>(max_ns_.load()) / 1e3; }
    // The upper end of the bucket that holds the share q of all (0 .. 1), at most max_us(); 0 without any.
    // Buckets are 2 us wide up to 20 ms; what is longer is known by the maximum only.
    double percentile_us(double q) const;
    void clear();

  private:
    static constexpr int kBuckets = 10000, kBucketNs = 2000;
    std::array<std::atomic<std::uint32_t>, kBuckets + 1> buckets_{};
    std::atomic<std::uint64_t> count_ = 0;
    std::atomic<std::int64_t> max_ns_ = 0;
};

struct CyclicCounters {
    std::uint64_t packets = 0;        // good ones
    std::uint64_t answers = 0;        // sent
    std::uint64_t late = 0;           // late answers as the robot counts them (RSI: Delay D), since the start
    std::uint64_t missed_cycles = 0;  // gaps in the cycle numbers
    std::uint64_t out_of_order = 0;   // older than or equal to one before; not answered
    std::uint64_t bad = 0;            // no packet of the protocol, or numbers that no robot can mean
    std::uint64_t strangers = 0;      // datagrams of another peer than the robot
    std::uint64_t sessions = 0;       // how often the robot began anew
    double latency_p50_us = 0, latency_p99_us = 0,
           latency_max_us = 0;  // datagram received -> answer handed over
};

}  // namespace seamwright
