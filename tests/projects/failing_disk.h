#pragma once
// A disk under SQLite that fails when the test says so: every write, sync and truncation of a database, its
// journal or its log is counted, and one of them, or all from one on, answers with an error as a full or
// broken disk does.

#include <cstdint>

namespace seamwright {

class FailingDisk {
  public:
    enum class Counts { everything, syncs };  // which operations are numbered
    enum class Fails { once, from_then_on };
    // The default VFS of every connection opened from here on, in this process. One at a time.
    FailingDisk();
    ~FailingDisk();
    FailingDisk(const FailingDisk&) = delete;
    FailingDisk& operator=(const FailingDisk&) = delete;

    // Counts from 1, from now on; the operation of that number fails.
    void fail_at(std::int64_t number, Fails fails, Counts counts);
    void count(Counts counts) { fail_at(0, Fails::once, counts); }
    void heal();  // nothing fails any more
    std::int64_t counted() const;
    bool failed() const;  // something did
};

}  // namespace seamwright
