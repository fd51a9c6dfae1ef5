#include "projects/file/chain/audit.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "projects/file/project_file_detail.h"

namespace seamwright {
namespace {

void append_field(std::string& line, std::string_view text) {
    if (!line.empty()) line += ',';
    line += '"';
    for (const char c : text) {
        if (c == '"') line += '"';
        line += c;
    }
    line += '"';
}

// The fields of RFC 4180, record by record. nullopt: a quote without its other.
std::optional<std::vector<std::vector<std::string>>> records_of(const std::string& text) {
    std::vector<std::vector<std::string>> records;
    std::vector<std::string> record;
    std::string field;
    bool quoted = false, any = false;
    const auto end_field = [&] {
        record.push_back(std::move(field));
        field.clear();
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c != '"')
                field += c;
            else if (i + 1 < text.size() && text[i + 1] == '"')
                field += text[++i];
            else
                quoted = false;
        } else if (c == '"') {
            quoted = any = true;
        } else if (c == ',') {
            end_field();
            any = true;
        } else if (c == '\n') {
            end_field();
            records.push_back(std::move(record));
            record.clear();
            any = false;
        } else if (c != '\r') {
            field += c;
            any = true;
        }
    }
    if (quoted) return std::nullopt;
    if (any) {
        end_field();
        records.push_back(std::move(record));
    }
    return records;
}

struct Earlier {
    std::int64_t number = 0;
    std::string hash;
};

tl::unexpected<Error> no_export(const std::string& name) {
    return input_error("this is no export of seamwright audit", name,
                       "give the CSV or JSON file of an earlier audit");
}

Expected<std::vector<Earlier>> entries_in(const std::string& text, const std::string& name) {
    std::vector<Earlier> list;
    if (const auto start = text.find_first_not_of(" \t\r\n");
        start != std::string::npos && text[start] == '{') {
        SEAM_TRY(const auto document, parse_json(text, name));
        SEAM_TRY(const auto* entries, json_array(document, "entries", name));
        for (const auto& entry : *entries) {
            SEAM_TRY(const auto number, json_number(entry, "number", name));
            SEAM_TRY(const auto hash, json_string(entry, "hash", name));
            list.push_back({static_cast<std::int64_t>(number), hash});
        }
        return list;
    }
    const auto records = records_of(text);
    if (!records || records->empty()) return no_export(name);
    const auto& header = records->front();
    const auto number = std::ranges::find(header, "number") - header.begin(),
               hash = std::ranges::find(header, "hash") - header.begin();
    const auto columns = static_cast<std::ptrdiff_t>(header.size());
    if (number == columns || hash == columns) return no_export(name);
    for (std::size_t i = 1; i < records->size(); ++i) {
        const auto& record = (*records)[i];
        if (record.size() != header.size()) return no_export(name);
        const std::string& figures = record[static_cast<std::size_t>(number)];
        Earlier e{0, record[static_cast<std::size_t>(hash)]};
        if (std::from_chars(figures.data(), figures.data() + figures.size(), e.number).ec != std::errc())
            return no_export(name);
        list.push_back(std::move(e));
    }
    return list;
}

}  // namespace

Expected<Audit> audit_of(const ProjectFile& file) {
    Audit audit;
    audit.file = file.path().string();
    SEAM_TRY(audit.findings, file.check_chain());
    SEAM_TRY(auto entries, file.chain());
    SEAM_TRY(const auto events, file.stored_events());
    std::map<std::string, const StoredEvent*> by_id;
    for (const StoredEvent& e : events) by_id.emplace(std::to_string(e.id), &e);
    for (ChainEntry& entry : entries) {
        AuditLine line;
        line.entry = std::move(entry);
        if (const auto it = line.entry.kind == "event" ? by_id.find(line.entry.subject) : by_id.end();
            it != by_id.end()) {
            const StoredEvent& e = *it->second;
            line.event = true;
            line.event_utc = e.utc;
            line.event_run = e.run;
            line.event_kind = e.kind;
            line.event_subject = e.subject;
            line.event_text = e.text;
        }
        audit.lines.push_back(std::move(line));
    }
    return audit;
}

std::string audit_csv(const Audit& audit) {
    std::string out =
        "number,utc,person,kind,subject,digest,note,hash,event_utc,event_run,event_kind,event_subject,event_"
        "text\r\n";
    for (const AuditLine& line : audit.lines) {
        const ChainEntry& e = line.entry;
        std::string record;
        append_field(record, std::to_string(e.number));
        for (const std::string* field :
             {&e.utc, &e.person, &e.kind, &e.subject, &e.digest, &e.note, &e.hash, &line.event_utc})
            append_field(record, *field);
        append_field(record, line.event ? std::to_string(line.event_run) : "");
        for (const std::string* field : {&line.event_kind, &line.event_subject, &line.event_text})
            append_field(record, *field);
        out += record + "\r\n";
    }
    return out;
}

nlohmann::json audit_json(const Audit& audit) {
    nlohmann::json out = {
        {"format", "seamwright audit 1"}, {"file", audit.file}, {"entries", nlohmann::json::array()}};
    for (const AuditLine& line : audit.lines) {
        const ChainEntry& e = line.entry;
        nlohmann::json entry = {{"number", e.number}, {"utc", e.utc},         {"person", e.person},
                                {"kind", e.kind},     {"subject", e.subject}, {"digest", e.digest},
                                {"note", e.note},     {"hash", e.hash}};
        if (line.event)
            entry["event"] = {{"utc", line.event_utc},
                              {"run", line.event_run},
                              {"kind", line.event_kind},
                              {"subject", line.event_subject},
                              {"text", line.event_text}};
        out["entries"].push_back(std::move(entry));
    }
    return out;
}

Expected<std::vector<Error>> audit_against(const Audit& audit, const std::string& earlier,
                                           const std::string& name) {
    SEAM_TRY(const auto entries, entries_in(earlier, name));
    for (const Earlier& e : entries) {
        const auto at = static_cast<std::size_t>(e.number - 1);
        if (e.number >= 1 && at < audit.lines.size() && audit.lines[at].entry.hash == e.hash) continue;
        const Text what =
            at < audit.lines.size()
                ? Text(
                      "entry {} of the chain is not the one that was exported: the file was "
                      "made anew from there on",
                      e.number)
                : Text("the chain ends at entry {}, the export at {}: the file is an older copy",
                       audit.lines.size(), entries.back().number);
        return std::vector<Error>{file_error(what, joined(audit.file, ": ", name),
                                             "ask who put it there, and take the newest backup")
                                      .value()};
    }
    return std::vector<Error>{};
}

Expected<std::vector<Error>> audit_against_head(const Audit& audit, const std::string& head) {
    if (head.size() != 64 || head.find_first_not_of("0123456789abcdef") != std::string::npos)
        return usage_error("a hash has 64 figures of 0-9 and a-f", head,
                           "copy it from the end of an earlier audit");
    if (std::ranges::any_of(audit.lines, [&](const AuditLine& line) { return line.entry.hash == head; }))
        return std::vector<Error>{};
    return std::vector<Error>{
        file_error("no entry of the chain has this hash: the file is an older copy, or was made anew",
                   audit.file, "ask who put it there, and take the newest backup")
            .value()};
}

}  // namespace seamwright
