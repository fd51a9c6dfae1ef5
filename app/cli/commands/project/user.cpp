// seamwright user: who may work with a project. seamwright audit: what was done to it, by whom.

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "core/system_text.h"
#include "devices/exchange/files.h"
#include "projects/file/chain/audit.h"
#include "projects/file/project_file.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct UserArguments {
    std::string file, name, role, new_password_file, password_out;
};

// Of a service that nobody types: 256 random bits, in a file that nobody else may read and that is not there yet.
Expected<std::string> made_password(const std::string& path) {
    SEAM_TRY(const auto password, random_password());
    const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    const std::string line = password + "\n";
    bool written = fd >= 0 && ::write(fd, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
                   ::fsync(fd) == 0;
    const int code = errno;
    if (fd >= 0) written = ::close(fd) == 0 && written;
    if (!written)
        return file_error(Text("the password's file cannot be made ({})", system_text(code)), path,
                          "name a file that is not there yet");
    return password;
}

Expected<std::string> new_password(const UserArguments& a) {
    if (!a.password_out.empty()) return made_password(a.password_out);
    return read_password({a.new_password_file, "SEAMWRIGHT_NEW_PASSWORD", "New password of " + a.name, true});
}

Expected<Role> role_of(const UserArguments& a) {
    const auto role = role_from(a.role);
    if (!role)
        return usage_error(Text("there is no role \"{}\"", a.role), "--role",
                           "choose one of: service, operator, engineer, administrator");
    return *role;
}

Answer listed(const std::vector<User>& users) {
    Answer answer;
    answer.json = {{"status", "ok"}, {"users", json::array()}};
    for (const User& u : users) {
        answer.json["users"].push_back(
            {{"name", u.name}, {"role", to_string(u.role)}, {"created_utc", u.created_utc}});
        answer.text += fmt::format("{:<14} {}  since {}\n", to_string(u.role), u.name, u.created_utc);
    }
    if (users.empty()) answer.text = "the project has no users: nobody is asked\n";
    return answer;
}

Expected<Answer> changed(ProjectFile& file, const Expected<void>& done) {
    if (!done) return tl::unexpected(done.error());
    SEAM_TRY(const auto users, file.users());
    return listed(users);
}

CLI::App* user_command(CommandLine& line, CLI::App& group, const std::shared_ptr<UserArguments>& a,
                       const char* name, const char* help, const char* example) {
    CLI::App* command = line.add(group, name, help, example);
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    if (std::string_view(name) == "list") return command;
    add_sign_in(command);
    command->add_option("name", a->name, "The user's name")->required();
    return command;
}

void add_password_options(CLI::App* command, const std::shared_ptr<UserArguments>& a) {
    auto* from = command
                     ->add_option("--new-password-file", a->new_password_file,
                                  "The new password is its first line; else SEAMWRIGHT_NEW_PASSWORD, else "
                                  "the terminal asks twice")
                     ->type_name("FILE");
    command
        ->add_option("--password-out", a->password_out,
                     "A random password into this new file that only you may read: of a service")
        ->type_name("FILE")
        ->excludes(from);
}

struct AuditArguments {
    std::string file, csv, head, since_export;
};

Expected<Answer> audit_command(const AuditArguments& a) {
    // To write, so that the chain of an older file begins in the file and not in memory alone.
    auto file = ProjectFile::open(a.file);
    if (!file) file = ProjectFile::open(a.file, FileAccess::read_only);
    if (!file) return tl::unexpected(file.error());
    SEAM_TRY(const auto audit, audit_of(*file));
    Answer answer;
    json findings = json::array();
    for (const Error& e : audit.findings) findings.push_back(e.sentence());
    if (!a.csv.empty()) {
        SEAM_OK(write_text_file(a.csv, audit_csv(audit)));
        answer.text += a.csv + " written\n";
    }
    std::vector<Error> against;
    if (!a.since_export.empty()) {
        SEAM_TRY(const auto earlier, read_text_file(a.since_export));
        SEAM_TRY(against, audit_against(audit, earlier, a.since_export));
    }
    if (!a.head.empty()) {
        SEAM_TRY(const auto more, audit_against_head(audit, a.head));
        against.insert(against.end(), more.begin(), more.end());
    }
    for (const Error& e : against) findings.push_back(e.sentence());
    const std::string head = audit.lines.empty() ? "" : audit.lines.back().entry.hash;
    answer.json = audit_json(audit);
    answer.json.update(
        {{"status", findings.empty() ? "ok" : "broken"}, {"head", head}, {"findings", findings}});
    answer.text += fmt::format("{} entries, the last one's hash {}\n", audit.lines.size(), head);
    for (const auto& s : findings) answer.text += "  " + s.get<std::string>() + "\n";
    answer.text += findings.empty() ? "every entry follows from the one before, and the file is as they say\n"
                                    : "the chain is broken\n";
    answer.exit_code = findings.empty() ? kExitOk : kExitDevice;
    return answer;
}

}  // namespace

void add_user(CommandLine& line) {
    CLI::App* group = line.group(
        "user",
        "Who may do what. A project without users asks nobody. Roles: operator (pushes), engineer (teaches, "
        "changes limits, "
        "acknowledges a step, and pushes),\nadministrator (users besides), service (pushes without a person: "
        "run --watch). The first user is an "
        "administrator.\nPasswords are never arguments: a file that only you may read, the environment, or "
        "typed.",
        "seamwright user add door.seam ada --role administrator\n"
        "  seamwright user add door.seam cell-7 --role service --password-out cell-7.key --user ada\n"
        "  seamwright run door.seam --watch --push --user cell-7 --password-file cell-7.key");
    auto a = std::make_shared<UserArguments>();
    CLI::App* list =
        user_command(line, *group, a, "list", "Names and roles.", "seamwright user list door.seam");
    line.on(list, [a]() -> Expected<Answer> {
        SEAM_TRY(auto file, ProjectFile::open(a->file, FileAccess::read_only));
        SEAM_TRY(const auto users, file.users());
        return listed(users);
    });
    CLI::App* add = user_command(line, *group, a, "add", "A new user.",
                                 "seamwright user add door.seam grace --role engineer --user ada");
    add->add_option("--role", a->role, "service, operator, engineer or administrator")->required();
    add_password_options(add, a);
    line.on(add, [a]() -> Expected<Answer> {
        SEAM_TRY(const Role role, role_of(*a));
        SEAM_TRY(auto file, open_to_edit(a->file));
        SEAM_OK(check_user_name(a->name));
        SEAM_OK(file.may(Deed::users));
        SEAM_TRY(const auto password, new_password(*a));
        return changed(file, file.add_user(a->name, role, password));
    });
    CLI::App* remove = user_command(line, *group, a, "remove",
                                    "Forget a user; what he did stays with his name. The last administrator "
                                    "stays while there are others.",
                                    "seamwright user remove door.seam grace --user ada");
    line.on(remove, [a]() -> Expected<Answer> {
        SEAM_TRY(auto file, open_to_edit(a->file));
        return changed(file, file.remove_user(a->name));
    });
    CLI::App* role = user_command(line, *group, a, "role", "Give a user another role.",
                                  "seamwright user role door.seam grace administrator --user ada");
    role->add_option("role", a->role, "service, operator, engineer or administrator")->required();
    line.on(role, [a]() -> Expected<Answer> {
        SEAM_TRY(const Role wanted, role_of(*a));
        SEAM_TRY(auto file, open_to_edit(a->file));
        return changed(file, file.set_role(a->name, wanted));
    });
    CLI::App* password = user_command(line, *group, a, "password",
                                      "A new password: one's own, or anybody's by an administrator.",
                                      "seamwright user password door.seam grace --user grace");
    add_password_options(password, a);
    line.on(password, [a]() -> Expected<Answer> {
        SEAM_TRY(auto file, open_to_edit(a->file));
        const bool own = file.person() && file.person()->name == a->name;
        if (!own) SEAM_OK(file.may(Deed::users));
        SEAM_TRY(const auto wanted, new_password(*a));
        return changed(file, file.set_password(a->name, wanted));
    });
}

void add_audit(CommandLine& line) {
    auto a = std::make_shared<AuditArguments>();
    CLI::App* command = line.add(
        "audit",
        "Everything that was done to a project, by whom, each entry with the hash of the one before "
        "(SHA-256): checked, and "
        "written for an audit.\nWhat the file alone cannot tell is whether all of it was put back to "
        "an older "
        "state or made anew: keep an export, or the last hash, elsewhere,\nand hold them against the "
        "file with --since-export and --head. Exit 3: the chain is broken.",
        "seamwright audit door.seam --csv audit.csv --json audit.json\n"
        "  seamwright audit door.seam --since-export audit-may.json");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command
        ->add_option("--csv", a->csv,
                     "One line an entry, with what each event says; --json FILE is the same as JSON")
        ->type_name("FILE.csv");
    command
        ->add_option("--since-export", a->since_export,
                     "An earlier export, CSV or JSON: its entries have to be in the file as they were")
        ->type_name("FILE");
    command->add_option("--head", a->head, "The last hash of an earlier audit: it has to be in the chain")
        ->type_name("HASH");
    line.on(command, [a] { return audit_command(*a); });
}

}  // namespace seamwright::cli
