#pragma once
// The chain of a project file (chain.h) for an audit: every entry, with the columns of the event where it is one, so that
// everything can be computed again from the text alone, and against an earlier export or its last hash.
//
// CSV: number,utc,person,kind,subject,digest,note,hash,event_utc,event_run,event_kind,event_subject,event_text; RFC 4180, every
// field quoted, lines end in CR LF. JSON: {"format", "file", "entries": [{..., "event": {"utc", "run", "kind", "subject",
// "text"}}]}. The event's text is that of the file, as the digest covers it: SHA-256 of the netstrings of "events", the
// entry's subject, utc, run, kind, subject, text.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "projects/file/project_file.h"

namespace seamwright {

struct AuditLine {
    ChainEntry entry;
    bool event = false;
    std::string event_utc, event_kind, event_subject, event_text;
    std::int64_t event_run = 0;
};
struct Audit {
    std::string file;
    std::vector<AuditLine> lines;
    std::vector<Error> findings;  // of ProjectFile::check_chain
};
Expected<Audit> audit_of(const ProjectFile& file);
std::string audit_csv(const Audit& audit);
nlohmann::json audit_json(const Audit& audit);

// Whether the file's chain goes on from what was exported earlier. Empty: it does. Error (input): that is no export.
Expected<std::vector<Error>> audit_against(const Audit& audit, const std::string& earlier,
                                           const std::string& name);
Expected<std::vector<Error>> audit_against_head(const Audit& audit, const std::string& head);

}  // namespace seamwright
