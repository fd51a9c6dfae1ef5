#pragma once
// The outbox: which finished runs a fleet's database has not taken yet, so that none is lost while it is away.
//
// A run is queued in the transaction that stores it as finished, and again whenever its outcome changes, with the number of its
// newest entry of the chain as its revision. It goes when the database has confirmed that revision; who is killed in between
// sends it once more, and the database knows it by its id.
//
// The id of a run is the hash of its first entry in the chain (chain/chain.h): no two runs share one, and a run in a copy of
// the file keeps it, whereas what the copy measures by itself has other ids under the same numbers. Runs that are older
// than the chain have one from the file's migration.
//
// A row is small: the message to be published is made when it is published, or before (ProjectFile::keep_message), as a
// watching does that keeps only the newest runs. A run that is deleted without a kept message is not published any more.

#include <cstdint>
#include <string>

#include "devices/capture/sqlite.h"

namespace seamwright {

struct QueuedRun {
    std::int64_t run = 0, revision = 0;
    std::string id;       // 64 figures, hex
    std::string message;  // as kept; empty: to be made of the run
};

// Within the caller's transaction, after the run's entry of the chain.
Expected<void> queue_run(Database& db, std::int64_t run);
// The run is deleted: it stays queued with a kept message alone.
Expected<void> forget_queued(Database& db, std::int64_t run);

}  // namespace seamwright
