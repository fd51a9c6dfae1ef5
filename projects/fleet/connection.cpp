#include "projects/fleet/connection.h"

#include <fmt/format.h>
#include <libpq-fe.h>
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <chrono>

namespace seamwright::fleet {
namespace {

struct Finish {
    void operator()(PGconn* c) const { PQfinish(c); }
};

struct Refused {
    std::string state;  // SQLSTATE; empty: no server answered
    bool needs_password = false, used_password = false;
    std::string words;
};

// "FATAL:  28P01: password authentication failed", the first word in the server's language; as libpq says it when it is
// asked to be verbose. Empty: no server said it.
std::string state_in(const std::string& words) {
    for (auto colon = words.find(": "); colon != std::string::npos; colon = words.find(": ", colon + 1)) {
        const auto code = words.find_first_not_of(' ', colon + 1);
        if (code == std::string::npos || code + 5 >= words.size() || words[code + 5] != ':') continue;
        std::string state = words.substr(code, 5);
        const auto sign = [](char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z'); };
        // Every code has a figure in it, "FATAL" has none.
        if (std::all_of(state.begin(), state.end(), sign) &&
            state.find_first_of("0123456789") != std::string::npos)
            return state;
    }
    return {};
}

// Why a connection does not come about. libpq tells a caller no SQLSTATE of that, but for a connection whose messages are asked to
// be verbose before it is made; so it is made once more, by hand.
Refused refusal(const FleetTarget& target) {
    const std::unique_ptr<PGconn, Finish> connection(PQconnectStart(target.connection().c_str()));
    Refused out;
    if (!connection) return out;
    PQsetErrorVerbosity(connection.get(), PQERRORS_VERBOSE);
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(6);
    PostgresPollingStatusType next = PGRES_POLLING_WRITING;
    while (PQstatus(connection.get()) != CONNECTION_BAD && next != PGRES_POLLING_OK &&
           next != PGRES_POLLING_FAILED) {
        pollfd wait{PQsocket(connection.get()),
                    static_cast<short>(next == PGRES_POLLING_READING ? POLLIN : POLLOUT), 0};
        if (std::chrono::steady_clock::now() > until) return out;
        if (::poll(&wait, 1, 100) > 0) next = PQconnectPoll(connection.get());
    }
    out.needs_password = PQconnectionNeedsPassword(connection.get()) != 0;
    out.used_password = PQconnectionUsedPassword(connection.get()) != 0;
    out.words = PQerrorMessage(connection.get());
    out.state = state_in(out.words);
    return out;
}

std::string first_line(std::string words) {
    words.resize(std::min(words.find('\n'), words.size()));
    return words;
}

Error connect_error(const FleetTarget& target, const std::string& said) {
    const Refused why = refusal(target);
    const auto error = [&](Text what, Text mend, ErrorCode code = ErrorCode::none) {
        return Error{ErrorKind::device, std::move(what), Text(target.name()), std::move(mend), code};
    };
    if (why.state == "28P01")
        return error("the database refuses the password",
                     "give the right one: PGPASSWORD, PGPASSFILE or ~/.pgpass");
    if (why.needs_password)
        return error("the database asks for a password and none is given",
                     "give it in PGPASSWORD, PGPASSFILE or ~/.pgpass");
    if (why.state == "28000")
        return error("the database does not let this user in",
                     "name a user that it knows, or allow it in pg_hba.conf");
    if (why.state == "3D000") return error("there is no such database", "make it: createdb NAME");
    if (why.state == "57P03")
        return error("the database server is starting or stopping", "try again", ErrorCode::not_ready);
    if (why.state == "53300")
        return error("the database server has no connection left", "raise its max_connections",
                     ErrorCode::in_use);
    if (why.state.empty())
        return error(Text("no database server answers ({})", target.cleaned(first_line(said))),
                     "is it running, and does it listen at this address?", ErrorCode::disconnected);
    return error(Text("the database refuses the connection: {}", target.cleaned(first_line(why.words))), {});
}

}  // namespace

bool refuses_data(const std::exception& e) {
    const std::string state = state_in(e.what());
    return state.starts_with("22") || state.starts_with("23") || state.starts_with("54");
}

Error error_of(const std::exception& e, const FleetTarget& target) {
    const Text where = target.name();
    const std::string words = target.cleaned(first_line(e.what())), state = state_in(e.what());
    const auto error = [&](Text what, Text mend, ErrorCode code = ErrorCode::none) {
        return Error{ErrorKind::device, std::move(what), where, std::move(mend), code};
    };
    if (dynamic_cast<const pqxx::broken_connection*>(&e) || dynamic_cast<const pqxx::in_doubt_error*>(&e) ||
        state.starts_with("57P") || state.starts_with("08"))
        return error(Text("the connection to the database broke ({})", words), "try again",
                     ErrorCode::disconnected);
    if (state == "42501")
        return error(Text("the database does not allow it ({})", words),
                     "grant the user the rights on the schema seamwright");
    if (state == "25006")
        return error("the database takes nothing, it is read-only", "name the primary server");
    return error(Text("the database refuses it ({})", words), {});
}

Expected<std::unique_ptr<pqxx::connection>> connect(const FleetTarget& target) {
    try {
        auto connection = std::make_unique<pqxx::connection>(target.connection());
        connection->set_verbosity(pqxx::connection_base::verbose);  // with SQLSTATE, which libpqxx 6 loses
        return connection;
    } catch (const std::exception& e) {
        return tl::unexpected(connect_error(target, e.what()));
    }
}

std::optional<int> schema_version(pqxx::transaction_base& work) {
    if (work.exec1("SELECT to_regclass('seamwright.migration')")[0].is_null()) return std::nullopt;
    return work.exec1("SELECT coalesce(max(version), 0) FROM seamwright.migration")[0].as<int>();
}

double number(const pqxx::field& field) {
    double value = 0;
    if (!field.is_null()) std::from_chars(field.c_str(), field.c_str() + field.size(), value);
    return value;
}

std::int64_t whole(const pqxx::field& field) {
    std::int64_t value = 0;
    if (!field.is_null()) std::from_chars(field.c_str(), field.c_str() + field.size(), value);
    return value;
}

}  // namespace seamwright::fleet
