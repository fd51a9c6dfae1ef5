#pragma once
// The chain: one entry for everything that is done to a project file, each holding the hash of the one before. It tells
// that a file was changed behind the program's back, where, and who did what by the program.
//
// An entry (table `chain`, and a line of `seamwright audit`) is
//   number    1, 2, 3, ... without a gap
//   utc       ISO 8601
//   person    who was signed in; empty: nobody
//   kind      begin, project, user, run, captures, event, events, setup, evidence, drift point, scan,
//             guide, sign in, sign out, wrong password
//   subject   what it is about: "regions R1", "5" of a run, a user's name
//   digest    of what it commits to; empty: that is gone
//   note      for people: what of a limit changed, a user's role
//   hash      SHA-256 of the netstrings (sha256.h), one after the other, of
//             "seamwright chain 1", the hash of the entry before (hex; empty in the first), number, utc, person, kind,
//             subject, digest (hex), note
// Numbers are decimal, hex is lower case, text is UTF-8. The first entry's digest is random; its hash is the file's
// identity, which users' passwords are bound to.
//
// Digest of a row: SHA-256 of the netstrings of its table's name and of its columns in the order of
// checksummed_tables(). project: any row of the project, "TABLE ID". run: the rows of runs, run_types, run_spots,
// run_regions and run_panels of that run one after the other, in the order of their positions; written when it is begun
// and each time its rows change. captures: of a finished run, the netstrings of the digests (hex) of its rows of captures
// and then of images. events: all events up to that id together, of a file that is older than the chain.
//
// What the chain cannot tell. It has no secret: who edits the file with a program that computes it anew from some entry
// on, or puts back an older copy of the whole file, leaves a chain that is right in itself. Both are seen by what was
// kept elsewhere: an audit's export, or its last hash (`seamwright audit --since-export`, `--head`). Raw data of runs that are
// older than the chain are not in it.
//
// A later migration that changes rows appends their entries.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/capture/sqlite.h"
#include "projects/file/chain/sha256.h"

namespace seamwright {

struct ChainEntry {
    std::int64_t number = 0;
    std::string utc, person, kind, subject;
    std::string digest;  // hex; empty: gone
    std::string note;
    std::string hash;  // hex
};
// What the hash of an entry is the SHA-256 of.
std::string chain_encoding(const ChainEntry& entry, const std::string& hash_before);

// Within the caller's transaction. `digest` empty: what it is about is gone.
Expected<void> append_chain(Database& db, const std::string& person, std::string_view kind,
                            std::string_view subject, std::span<const std::byte> digest,
                            std::string_view note = {});
// The first entry, and one for all that a file of an older version holds. Within the caller's transaction.
Expected<void> begin_chain(Database& db, std::int32_t from_version);

// Of the row whose `key` of checksummed_tables() is `id`. Error (file): there is none.
Expected<Digest> row_digest(Database& db, std::string_view table, std::string_view id);
Expected<Digest> row_digest(Database& db, std::string_view table, std::int64_t id);
Expected<Digest> run_digest(Database& db, std::int64_t number);
// Of one row of captures or images as it is inserted: `numbers` in front of the data.
Digest blob_row_digest(std::string_view table, std::span<const std::int64_t> numbers,
                       std::span<const std::byte> data);
Digest captures_digest(std::span<const Digest> captures, std::span<const Digest> images);
// Of the rows that are stored of a run.
Expected<Digest> stored_captures_digest(Database& db, std::int64_t run);

// The identity of the file: the hash of its first entry. Error (file): the chain is gone.
Expected<std::string> chain_identity(Database& db);
// Whether project and users are as their last entries say, and the last entry follows from the one before: what a file
// is asked before it is worked with. nullopt: they are.
Expected<std::optional<Error>> chain_trouble(Database& db);
// Every entry against the one before; the first that is wrong.
Expected<std::optional<Error>> check_links(Database& db);
// Both, and every row of the file against its last entry. The first finding is the first wrong entry.
Expected<std::vector<Error>> check_chain(Database& db);

}  // namespace seamwright
