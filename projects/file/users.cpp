// Users of a project file: their passwords, who is signed in, and what he may.

#include "projects/model/users.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <cmath>

#include "projects/file/chain/chain.h"
#include "projects/file/id_length.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {
namespace {

// argon2id, version 1.3 (RFC 9106): a guess costs 64 MiB and a tenth of a second or more, on any computer that
// has the file.
constexpr unsigned long long kPasses = 3;
constexpr std::size_t kMemoryBytes = std::size_t{64} << 20;
constexpr std::size_t kShortestPassword = 8, kLongestPassword = 1024;

Expected<void> sodium_ready() {
    if (sodium_init() < 0) return file_error("the computer gives no random numbers");
    return {};
}

// A hash counts for one user of one file: one that is copied to another row or file fits nothing.
std::string bound(const std::string& identity, const std::string& name, const std::string& password) {
    std::string out;
    for (const std::string* part : {&identity, &name, &password}) append_netstring(out, *part);
    return out;
}

Expected<std::string> hashed(const std::string& identity, const std::string& name,
                             const std::string& password) {
    SEAM_OK(sodium_ready());
    std::string said = bound(identity, name, password);
    std::string hash(crypto_pwhash_STRBYTES, '\0');
    const int failed = crypto_pwhash_str_alg(hash.data(), said.data(), said.size(), kPasses, kMemoryBytes,
                                             crypto_pwhash_ALG_ARGON2ID13);
    sodium_memzero(said.data(), said.size());
    if (failed) return file_error("a password needs more memory than there is");
    hash.resize(hash.find('\0'));
    return hash;
}

bool fits(const std::string& hash, const std::string& identity, const std::string& name,
          const std::string& password) {
    if (!sodium_ready()) return false;
    // A hash that asks for more than ours do was not made here.
    if (crypto_pwhash_str_needs_rehash(hash.c_str(), kPasses, kMemoryBytes) != 0) return false;
    std::string said = bound(identity, name, password);
    const bool right = crypto_pwhash_str_verify(hash.c_str(), said.data(), said.size()) == 0;
    sodium_memzero(said.data(), said.size());
    return right;
}

// One sign of UTF-8 from `at` on; what is none is 0xFFFFFFFF. The text is valid UTF-8 otherwise.
char32_t next_sign(const std::string& text, std::size_t& at) {
    const auto byte = [&](std::size_t i) {
        return static_cast<char32_t>(static_cast<unsigned char>(text[i]));
    };
    const char32_t first = byte(at++);
    if (first < 0x80) return first;
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : -1;
    if (more < 0) return 0xFFFFFFFF;
    char32_t sign = first & (0x3Fu >> more);
    for (int i = 0; i < more; ++i) {
        if (at >= text.size() || (byte(at) & 0xC0) != 0x80) return 0xFFFFFFFF;
        sign = sign << 6 | (byte(at++) & 0x3F);
    }
    return sign;
}

// Controls, and what changes how other signs are shown without being seen itself.
bool unseen(char32_t c) {
    return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0xAD || c == 0x61C || (c >= 0x180B && c <= 0x180F) ||
           (c >= 0x200B && c <= 0x200F) || (c >= 0x2028 && c <= 0x202E) || (c >= 0x2060 && c <= 0x206F) ||
           c == 0xFEFF || (c >= 0xFFF9 && c <= 0xFFFB) || (c >= 0xE0000 && c <= 0xE0FFF) || c == 0xFFFFFFFF;
}

std::string small_letters(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

Expected<void> check_password(const std::string& name, const std::string& password) {
    if (password.size() < kShortestPassword || password.size() > kLongestPassword)
        return input_error(Text("a password has {} to {} bytes", kShortestPassword, kLongestPassword), name,
                           "choose a longer one, several words for example");
    if (small_letters(password) == small_letters(name))
        return input_error("the password is the user's name", name, "choose another one");
    return {};
}

struct StoredUser {
    User user;
    std::string password;
};
Expected<std::vector<StoredUser>> stored_users(Database& db) {
    SEAM_OK(check_rows(db, "users"));
    SEAM_TRY(auto s,
             db.prepare("SELECT id, role, password, created_utc FROM users ORDER BY created_utc, id"));
    std::vector<StoredUser> users;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        const auto role = role_from(row.text(1));
        if (!role) return file_error("a user has an unknown role", joined(db.path(), ": ", row.text(0)));
        users.push_back({{row.text(0), *role, row.text(3)}, row.text(2)});
        return {};
    }));
    return users;
}

const StoredUser* find_user(const std::vector<StoredUser>& users, const std::string& name) {
    const auto it = std::ranges::find_if(users, [&](const StoredUser& u) { return u.user.name == name; });
    return it == users.end() ? nullptr : &*it;
}

Error no_such_user(const std::string& path, const std::string& name) {
    return input_error(Text("the project has no user \"{}\"", utf8_text(name)), path,
                       "seamwright user list FILE.seam names them")
        .value();
}

// So many administrators stay when `without` is none any more.
std::ptrdiff_t other_administrators(const std::vector<StoredUser>& users, const std::string& without) {
    return std::ranges::count_if(users, [&](const StoredUser& u) {
        return u.user.role == Role::administrator && u.user.name != without;
    });
}

// How long after wrong passwords in a row the next one is not looked at.
double delay_s(std::int64_t wrong) {
    return wrong < 3 ? 0 : std::min(300.0, 5 * std::pow(2.0, static_cast<double>(wrong - 3)));
}

// Error (usage): too soon after wrong ones. A clock that was put back delays nobody.
Expected<void> check_delay(Database& db, const std::string& name) {
    SEAM_TRY(auto s,
             db.prepare("SELECT count(*), ifnull(CAST((julianday('now') - julianday(max(utc))) * 86400000 "
                        "AS INTEGER), 0) FROM chain WHERE kind = 'wrong password' AND subject = ?1 AND "
                        "number > ifnull((SELECT max(number) FROM chain WHERE kind IN ('sign in', "
                        "'user') AND subject = ?1), 0)"));
    s.bind(1, name);
    SEAM_OK(s.step());
    const std::int64_t wrong = s.integer(0);
    const double since_s = static_cast<double>(s.integer(1)) / 1000;
    s.reset();
    const double wait = delay_s(wrong) - since_s;
    if (wait <= 0 || since_s < 0) return {};
    return usage_error(
        Text("{} wrong passwords in a row", wrong), name,
        Text("try again in {:.0f} s, or have an administrator set a new one", std::ceil(wait)));
}

}  // namespace

Expected<void> check_user_name(const std::string& name) {
    const auto wrong = [&](const Text& why) {
        std::string shown;
        for (const char c : name.substr(0, 64))
            shown += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
        return input_error(why, utf8_text(shown), "give a name of letters, figures and single spaces");
    };
    if (name.empty()) return wrong("the user has no name");
    if (is_too_long(name)) return wrong(Text("a user's name has at most {} signs", kLongestId));
    for (std::size_t at = 0; at < name.size();)
        if (unseen(next_sign(name, at))) return wrong("a sign of the user's name is not seen");
    if (utf8_text(name) != name) return wrong("the user's name is not UTF-8");
    if (name.front() == ' ' || name.back() == ' ' || name.front() == '-')
        return wrong("a user's name begins or ends with a space or a dash");
    return {};
}

Expected<std::string> random_password() {
    SEAM_OK(sodium_ready());
    Digest random;
    randombytes_buf(random.data(), random.size());
    return hex(random);
}

Expected<std::vector<User>> ProjectFile::users() const {
    SEAM_TRY(const auto stored, stored_users(impl_->db));
    std::vector<User> users;
    for (const StoredUser& u : stored) users.push_back(u.user);
    return users;
}

Expected<void> ProjectFile::may(Deed deed) const {
    if (impl_->trouble) return tl::unexpected(*impl_->trouble);
    SEAM_TRY(const std::int64_t users, impl_->db.integer("SELECT count(*) FROM users"));
    if (users == 0) return {};
    if (!impl_->person)
        return usage_error(Text("nobody is signed in: {} needs a person", name_of(deed)),
                           impl_->path.string(), "sign in; on the command line --user NAME");
    SEAM_OK(check_rows(impl_->db, "users"));
    SEAM_TRY(auto s, impl_->db.prepare("SELECT role FROM users WHERE id = ?"));
    s.bind(1, impl_->person->name);
    SEAM_TRY(auto row, s.step());
    const auto role = row ? role_from(s.text(0)) : std::nullopt;
    s.reset();
    if (!role) return tl::unexpected(no_such_user(impl_->path.string(), impl_->person->name));
    impl_->person->role = *role;
    if (allows(*role, deed)) return {};
    return usage_error(
        Text("{} is {}, which does not allow {}", impl_->person->name, to_string(*role), name_of(deed)),
        impl_->path.string(),
        deed == Deed::users ? Text("sign in as an administrator")
                            : Text("sign in as an engineer or administrator"));
}

const std::optional<Person>& ProjectFile::person() const {
    return impl_->person;
}

Expected<void> ProjectFile::note_user(const std::string& name, const Text& text) {
    SEAM_OK(append_event_row({0, utc_now(), 0, EventKind::note, "user " + name, text}));
    return {};
}

Expected<void> ProjectFile::add_user(const std::string& name, Role role, const std::string& password) {
    Database& db = impl_->db;
    SEAM_OK(check_user_name(name));
    SEAM_OK(check_password(name, password));
    SEAM_OK(may(Deed::users));
    SEAM_TRY(const auto identity, chain_identity(db));
    SEAM_TRY(const auto hash, hashed(identity, name, password));
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_OK(may(Deed::users));
    SEAM_TRY(const auto users, stored_users(db));
    if (users.empty() && role != Role::administrator)
        return usage_error(Text("the first user is an administrator, not {}", to_string(role)), name,
                           "say --role administrator, and add the others afterwards");
    for (const StoredUser& u : users)
        if (small_letters(u.user.name) == small_letters(name))
            return input_error(Text("there is a user \"{}\" already", u.user.name), impl_->path.string(),
                               "give another name");
    SEAM_TRY(auto s,
             db.prepare("INSERT INTO users (id, role, password, created_utc, checksum) VALUES (?1, ?2, "
                        "?3, ?4, row_checksum(?1, ?2, ?3, ?4))"));
    const std::string now = utc_now();
    s.bind(1, name);
    s.bind(2, to_string(role));
    s.bind(3, hash);
    s.bind(4, now);
    SEAM_OK(s.run());
    SEAM_OK(chain_user(name, fmt::format("added: {}", to_string(role))));
    SEAM_OK(note_user(name, Text("the user was added: {}", to_string(role))));
    return transaction.commit();
}

Expected<void> ProjectFile::remove_user(const std::string& name) {
    Database& db = impl_->db;
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_OK(may(Deed::users));
    SEAM_TRY(const auto users, stored_users(db));
    if (!find_user(users, name)) return tl::unexpected(no_such_user(impl_->path.string(), name));
    if (users.size() > 1 && other_administrators(users, name) == 0)
        return usage_error("the last administrator stays as long as there are other users", name,
                           "make another user administrator first, or remove the others");
    SEAM_TRY(auto s, db.prepare("DELETE FROM users WHERE id = ?"));
    s.bind(1, name);
    SEAM_OK(s.run());
    SEAM_OK(append_chain(db, impl_->name(), "user", name, {}, "removed"));
    SEAM_OK(note_user(name, users.size() > 1 ? Text("the user was removed")
                                             : Text("the last user was removed: nobody is asked any more")));
    return transaction.commit();
}

Expected<void> ProjectFile::set_role(const std::string& name, Role role) {
    Database& db = impl_->db;
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_OK(may(Deed::users));
    SEAM_TRY(const auto users, stored_users(db));
    if (!find_user(users, name)) return tl::unexpected(no_such_user(impl_->path.string(), name));
    if (role != Role::administrator && other_administrators(users, name) == 0)
        return usage_error("the last administrator stays one", name, "make another user administrator first");
    SEAM_TRY(auto s, db.prepare("UPDATE users SET role = ? WHERE id = ?"));
    s.bind(1, to_string(role));
    s.bind(2, name);
    SEAM_OK(s.run());
    SEAM_OK(chain_user(name, fmt::format("role: {}", to_string(role))));
    SEAM_OK(note_user(name, Text("the user's role is {} from here on", to_string(role))));
    return transaction.commit();
}

Expected<void> ProjectFile::set_password(const std::string& name, const std::string& password) {
    Database& db = impl_->db;
    SEAM_OK(check_password(name, password));
    const auto allowed = [&]() -> Expected<void> {
        if (impl_->trouble) return tl::unexpected(*impl_->trouble);
        if (impl_->person && impl_->person->name == name) return {};  // his own
        return may(Deed::users);
    };
    SEAM_OK(allowed());
    SEAM_TRY(const auto identity, chain_identity(db));
    SEAM_TRY(const auto hash, hashed(identity, name, password));
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_OK(allowed());
    SEAM_TRY(const auto users, stored_users(db));
    if (!find_user(users, name)) return tl::unexpected(no_such_user(impl_->path.string(), name));
    SEAM_TRY(auto s, db.prepare("UPDATE users SET password = ? WHERE id = ?"));
    s.bind(1, hash);
    s.bind(2, name);
    SEAM_OK(s.run());
    SEAM_OK(chain_user(name, "password"));
    SEAM_OK(note_user(name, "the user has a new password"));
    return transaction.commit();
}

// The user's row as it stands, into the checksum and the chain. Within the caller's transaction.
Expected<void> ProjectFile::chain_user(const std::string& name, const std::string& what) {
    Database& db = impl_->db;
    SEAM_TRY(auto seal,
             db.prepare("UPDATE users SET checksum = row_checksum(id, role, password, created_utc) "
                        "WHERE id = ?"));
    seal.bind(1, name);
    SEAM_OK(seal.run());
    SEAM_TRY(const Digest digest, row_digest(db, "users", name));
    return append_chain(db, impl_->name(), "user", name, digest, what);
}

Expected<SignedIn> ProjectFile::sign_in(const std::string& name, const std::string& password) {
    Database& db = impl_->db;
    const std::string path = impl_->path.string();
    // Whoever put a user of his own into the table would have had to put him into the chain too.
    SEAM_TRY(auto broken, check_links(db));
    if (!broken) {
        SEAM_TRY(broken, chain_trouble(db));
    }
    if (broken) {
        impl_->trouble = broken;
        return tl::unexpected(*broken);
    }
    SEAM_TRY(const auto users, stored_users(db));
    if (users.empty())
        return usage_error("the project has no users", path,
                           "leave the user out, or add one: seamwright user add");
    SEAM_OK(check_user_name(name));
    SEAM_OK(check_delay(db, name));
    SEAM_TRY(const auto identity, chain_identity(db));
    const StoredUser* user = find_user(users, name);
    // As long for a name that is none.
    SEAM_TRY(const auto some, user ? Expected<std::string>(user->password) : hashed(identity, name, "none"));
    const bool right = password.size() <= kLongestPassword && fits(some, identity, name, password) && user;

    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_OK(check_delay(db, name));  // of wrong ones that other programs tried meanwhile
    if (!right) {
        SEAM_OK(append_chain(db, {}, "wrong password", name, {}));
        SEAM_OK(append_event_row({0, utc_now(), 0, EventKind::refusal, "user " + name,
                                  "signing in failed: user or password is wrong"}));
        SEAM_OK(transaction.commit());
        return usage_error("user or password is wrong", name,
                           "try again; an administrator can set a new password");
    }
    SEAM_TRY(const Digest row, row_digest(db, "users", name));
    impl_->person = Person{name, user->user.role};
    const auto entered = [&]() -> Expected<void> {
        SEAM_OK(append_chain(db, name, "sign in", name, {}, to_string(user->user.role)));
        SEAM_OK(note_user(name, Text("signed in as {}", to_string(user->user.role))));
        return transaction.commit();
    }();
    if (!entered) {
        impl_->person.reset();
        return tl::unexpected(entered.error());
    }
    SignedIn token;
    token.person_ = *impl_->person;
    token.row_ = hex(row);
    token.identity_ = identity;
    return token;
}

Expected<void> ProjectFile::act_for(const SignedIn& who) {
    SEAM_TRY(const auto identity, chain_identity(impl_->db));
    if (identity != who.identity_)
        return usage_error("the person is signed in to another project", impl_->path.string(),
                           "sign in here");
    SEAM_TRY(const Digest row, row_digest(impl_->db, "users", who.person_.name));
    if (hex(row) != who.row_)
        return usage_error("the user was changed meanwhile", who.person_.name, "sign in again");
    impl_->person = who.person_;
    return {};
}

Expected<void> ProjectFile::sign_out(const Text& why) {
    if (!impl_->person) return {};
    const std::string name = impl_->person->name;
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_OK(append_chain(impl_->db, name, "sign out", name, {}));
    SEAM_OK(note_user(name, why));
    SEAM_OK(transaction.commit());
    impl_->person.reset();
    return {};
}

void ProjectFile::forget_person() {
    impl_->person.reset();
}

}  // namespace seamwright
