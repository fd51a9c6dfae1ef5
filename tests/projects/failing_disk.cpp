#include "tests/projects/failing_disk.h"

#include <sqlite3.h>

#include <atomic>
#include <cassert>
#include <cstring>
#include <string>

namespace seamwright {
namespace {

struct State {
    std::atomic<std::int64_t> at = 0, counted = 0;
    std::atomic<bool> once = true, syncs = true, armed = false, failed = false;
};
State disk;
sqlite3_vfs* real = nullptr;

// True when this operation is to fail.
bool fails(bool sync) {
    if (!disk.armed || (disk.syncs && !sync)) return false;
    const std::int64_t number = ++disk.counted;
    const bool now = disk.at > 0 && (disk.once ? number == disk.at : number >= disk.at);
    if (now) disk.failed = true;
    return now;
}

struct File {
    sqlite3_file base;
    sqlite3_file* real;
};
sqlite3_file* under(sqlite3_file* file) {
    return reinterpret_cast<File*>(file)->real;
}
#define REAL(file) under(file)->pMethods

const sqlite3_io_methods kMethods = {
    3,
    [](sqlite3_file* f) {
        const int code = REAL(f)->xClose(under(f));
        f->pMethods = nullptr;
        return code;
    },
    [](sqlite3_file* f, void* to, int n, sqlite3_int64 at) { return REAL(f)->xRead(under(f), to, n, at); },
    [](sqlite3_file* f, const void* from, int n, sqlite3_int64 at) {
        return fails(false) ? SQLITE_FULL : REAL(f)->xWrite(under(f), from, n, at);
    },
    [](sqlite3_file* f, sqlite3_int64 size) {
        return fails(false) ? SQLITE_IOERR_TRUNCATE : REAL(f)->xTruncate(under(f), size);
    },
    [](sqlite3_file* f, int flags) {
        return fails(true) ? SQLITE_IOERR_FSYNC : REAL(f)->xSync(under(f), flags);
    },
    [](sqlite3_file* f, sqlite3_int64* size) { return REAL(f)->xFileSize(under(f), size); },
    [](sqlite3_file* f, int level) { return REAL(f)->xLock(under(f), level); },
    [](sqlite3_file* f, int level) { return REAL(f)->xUnlock(under(f), level); },
    [](sqlite3_file* f, int* out) { return REAL(f)->xCheckReservedLock(under(f), out); },
    [](sqlite3_file* f, int op, void* arg) { return REAL(f)->xFileControl(under(f), op, arg); },
    [](sqlite3_file* f) { return REAL(f)->xSectorSize(under(f)); },
    [](sqlite3_file* f) { return REAL(f)->xDeviceCharacteristics(under(f)); },
    [](sqlite3_file* f, int page, int size, int extend, void volatile** out) {
        return REAL(f)->xShmMap(under(f), page, size, extend, out);
    },
    [](sqlite3_file* f, int offset, int n, int flags) {
        return REAL(f)->xShmLock(under(f), offset, n, flags);
    },
    [](sqlite3_file* f) { REAL(f)->xShmBarrier(under(f)); },
    [](sqlite3_file* f, int remove) { return REAL(f)->xShmUnmap(under(f), remove); },
    [](sqlite3_file* f, sqlite3_int64 at, int n, void** out) {
        return REAL(f)->xFetch(under(f), at, n, out);
    },
    [](sqlite3_file* f, sqlite3_int64 at, void* p) { return REAL(f)->xUnfetch(under(f), at, p); }};

int open(sqlite3_vfs*, sqlite3_filename name, sqlite3_file* file, int flags, int* out) {
    File* f = reinterpret_cast<File*>(file);
    f->base.pMethods = nullptr;
    f->real = reinterpret_cast<sqlite3_file*>(f + 1);
    std::memset(static_cast<void*>(f->real), 0, static_cast<std::size_t>(real->szOsFile));
    const int code = real->xOpen(real, name, f->real, flags, out);
    if (f->real->pMethods) f->base.pMethods = &kMethods;
    return code;
}

sqlite3_vfs& shim() {
    static sqlite3_vfs vfs = [] {
        real = sqlite3_vfs_find(nullptr);
        sqlite3_vfs v = *real;  // the rest (names, random numbers, time) goes to the real one
        v.zName = "failing";
        v.pNext = nullptr;
        v.szOsFile = static_cast<int>(sizeof(File)) + real->szOsFile;
        v.xOpen = open;
        return v;
    }();
    return vfs;
}

}  // namespace

FailingDisk::FailingDisk() {
    [[maybe_unused]] const int code = sqlite3_vfs_register(&shim(), 1);
    assert(code == SQLITE_OK);
}
FailingDisk::~FailingDisk() {
    heal();
    sqlite3_vfs_register(real, 1);
}
void FailingDisk::fail_at(std::int64_t number, Fails fails, Counts counts) {
    disk.armed = false;
    disk.at = number;
    disk.counted = 0;
    disk.failed = false;
    disk.once = fails == Fails::once;
    disk.syncs = counts == Counts::syncs;
    disk.armed = true;
}
void FailingDisk::heal() {
    disk.armed = false;
}
std::int64_t FailingDisk::counted() const {
    return disk.counted;
}
bool FailingDisk::failed() const {
    return disk.failed;
}

}  // namespace seamwright
