#include "projects/fleet/target.h"

#include <libpq-fe.h>

#include <map>
#include <memory>

namespace seamwright {
namespace {

struct FreeOptions {
    void operator()(PQconninfoOption* o) const { PQconninfoFree(o); }
};

// As libpq reads a value between quotes.
std::string quoted(const std::string& value) {
    std::string out = "'";
    for (const char c : value) {
        if (c == '\'' || c == '\\') out += '\\';
        out += c;
    }
    return out + "'";
}

}  // namespace

Expected<FleetTarget> FleetTarget::from(const std::string& uri) {
    const auto wrong = [] {
        return usage_error("this is no address of a PostgreSQL database", "fleet",
                           "write postgresql://user@host:5432/database; signs like @ : / in a password are "
                           "written as %40 %3A %2F");
    };
    if (!uri.starts_with("postgresql://") && !uri.starts_with("postgres://")) return wrong();
    if (uri.find('\0') != std::string::npos) return wrong();
    char* message = nullptr;
    const std::unique_ptr<PQconninfoOption, FreeOptions> options(PQconninfoParse(uri.c_str(), &message));
    PQfreemem(message);
    if (!options) return wrong();
    std::map<std::string, std::string> given;
    for (const PQconninfoOption* o = options.get(); o->keyword; ++o)
        if (o->val) given[o->keyword] = o->val;
    FleetTarget target;
    target.password_ = given["password"];
    target.name_ = "postgresql://";
    if (!given["user"].empty()) target.name_ += given["user"] + "@";
    target.name_ += given["host"].empty() ? given["hostaddr"] : given["host"];
    if (!given["port"].empty()) target.name_ += ":" + given["port"];
    target.name_ += "/" + given["dbname"];
    if (given["passfile"].empty()) given.erase("passfile");
    if (given["connect_timeout"].empty()) given["connect_timeout"] = "5";
    if (given["tcp_user_timeout"].empty()) given["tcp_user_timeout"] = "10000";
    if (given["application_name"].empty()) given["application_name"] = "seamwright";
    given["client_encoding"] = "UTF8";
    for (const auto& [keyword, value] : given)
        if (!value.empty())
            target.connection_ += (target.connection_.empty() ? "" : " ") + keyword + "=" + quoted(value);
    return target;
}

std::string FleetTarget::cleaned(std::string words) const {
    if (password_.empty()) return words;
    for (auto at = words.find(password_); at != std::string::npos; at = words.find(password_, at + 3))
        words.replace(at, password_.size(), "***");
    return words;
}

}  // namespace seamwright
