#include "tests/projects/batch/slurm_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

namespace seamwright {
namespace {

namespace fs = std::filesystem;

// Two that are free at the same time.
std::array<int, 2> free_ports() {
    std::array<int, 2> ports{}, sockets{};
    for (std::size_t i = 0; i < 2; ++i) {
        sockets[i] = ::socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_addr.s_addr = htonl(INADDR_ANY);
        socklen_t size = sizeof at;
        if (::bind(sockets[i], reinterpret_cast<sockaddr*>(&at), size) == 0 &&
            ::getsockname(sockets[i], reinterpret_cast<sockaddr*>(&at), &size) == 0)
            ports[i] = ntohs(at.sin_port);
    }
    for (const int s : sockets) ::close(s);
    return ports;
}

}  // namespace

std::string SlurmServer::ask(const std::string& command) {
    std::string out;
    FILE* pipe = ::popen((command + " 2>&1 </dev/null").c_str(), "r");
    if (!pipe) return "popen failed";
    std::array<char, 4096> buffer{};
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
        out.append(buffer.data(), n);
    ::pclose(pipe);
    return out;
}

pid_t SlurmServer::begin(const std::vector<std::string>& words, const std::string& log) const {
    std::vector<std::string> copies = words;
    std::vector<char*> arguments;
    for (std::string& word : copies) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const std::string out = (folder_ / log).string();
    const pid_t child = ::fork();
    if (child != 0) return child;
    const int file = ::open(out.c_str(), O_CREAT | O_WRONLY | O_APPEND, 0600);
    ::dup2(file, 1);
    ::dup2(file, 2);
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
}

void SlurmServer::end(pid_t& child, int signal) {
    if (child <= 0) return;
    ::kill(child, signal);
    for (int i = 0; i < 300; ++i) {
        if (::waitpid(child, nullptr, WNOHANG) == child) {
            child = -1;
            return;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    child = -1;
}

bool SlurmServer::answers() const {
    for (int i = 0; i < 300; ++i) {
        if (const std::string nodes = ask("sinfo --noheader --format=%T");
            nodes.starts_with("idle") || nodes.starts_with("mixed") || nodes.starts_with("allocated"))
            return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
}

std::unique_ptr<SlurmServer> SlurmServer::start(int cpus, std::string& why) {
    for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch"})
        if (ask(fmt::format("command -v {} || command -v /usr/sbin/{}", program, program)).empty()) {
            why = fmt::format("{} is not installed (./run test slurm installs it)", program);
            return nullptr;
        }
    if (::geteuid() != 0) {
        why = "slurmd runs as root alone";
        return nullptr;
    }
    std::array<char, 64> name{"/tmp/seamwright-slurm-XXXXXX"};
    if (!::mkdtemp(name.data())) {
        why = "no temporary folder";
        return nullptr;
    }
    std::unique_ptr<SlurmServer> s(new SlurmServer);
    s->folder_ = name.data();
    const std::string f = s->folder_.string();
    for (const char* folder : {"munge", "state", "spool"}) fs::create_directory(s->folder_ / folder);
    {
        std::ofstream key(s->folder_ / "munge/key", std::ios::binary);
        std::random_device random;
        for (int i = 0; i < 256; ++i) {
            const unsigned word = random();
            key.write(reinterpret_cast<const char*>(&word), sizeof word);
        }
    }
    fs::permissions(s->folder_ / "munge/key", fs::perms::owner_read);
    std::string host = ask("hostname -s");
    while (!host.empty() && host.back() == '\n') host.pop_back();
    const auto ports = free_ports();
    std::ofstream(s->folder_ / "slurm.conf") << fmt::format(
        "ClusterName=seamwright\nSlurmctldHost={0}(127.0.0.1)\nSlurmUser=root\nSlurmdUser=root\n"
        "AuthType=auth/munge\nAuthInfo=socket={1}/munge/socket\nCredType=cred/munge\n"
        "SlurmctldPort={2}\nSlurmdPort={3}\nStateSaveLocation={1}/state\nSlurmdSpoolDir={1}/spool\n"
        "SlurmctldPidFile={1}/slurmctld.pid\nSlurmdPidFile={1}/slurmd.pid\nSlurmctldLogFile={1}/"
        "slurmctld.log\n"
        "SlurmdLogFile={1}/slurmd.log\nProctrackType=proctrack/pgid\nTaskPlugin=task/none\nSelectType=select/"
        "cons_tres\n"
        "SelectTypeParameters=CR_CPU\nMpiDefault=none\nSwitchType=switch/"
        "none\nJobAcctGatherType=jobacct_gather/none\n"
        "AccountingStorageType=accounting_storage/none\nReturnToService=2\nKillWait=2\n"
        "SchedulerParameters=sched_interval=1,batch_sched_delay=0\n"
        "NodeName={0} NodeAddr=127.0.0.1 CPUs={4} State=UNKNOWN\nPartitionName=all Nodes={0} Default=YES "
        "MaxTime=INFINITE State=UP\n",
        host, f, ports[0], ports[1], cpus);
    ::setenv("SLURM_CONF", (s->folder_ / "slurm.conf").c_str(), 1);
    if (const char* path = std::getenv("PATH"))
        ::setenv("PATH", (std::string(path) + ":/usr/sbin").c_str(), 1);
    s->munge_ = s->begin({"munged", "--foreground", "--force", "--key-file=" + f + "/munge/key",
                          "--socket=" + f + "/munge/socket", "--pid-file=" + f + "/munge/pid",
                          "--log-file=" + f + "/munge/log", "--seed-file=" + f + "/munge/seed"},
                         "munged.txt");
    for (int i = 0; i < 100 && !fs::exists(s->folder_ / "munge/socket"); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    s->controller_ = s->begin({"slurmctld", "-D", "-f", f + "/slurm.conf"}, "slurmctld.txt");
    s->node_ = s->begin({"slurmd", "-D", "-f", f + "/slurm.conf"}, "slurmd.txt");
    if (!s->answers()) {
        why = "Slurm does not start: " + ask("tail -n 3 " + f + "/slurmctld.txt " + f + "/slurmd.txt");
        return nullptr;
    }
    return s;
}

void SlurmServer::kill_controller() {
    end(controller_, SIGKILL);
}

bool SlurmServer::resume_controller() {
    const std::string f = folder_.string();
    controller_ = begin({"slurmctld", "-D", "-f", f + "/slurm.conf"}, "slurmctld.txt");
    return answers();
}

SlurmServer::~SlurmServer() {
    if (controller_ > 0) ask("scancel --user=root --signal=KILL");
    end(controller_, SIGTERM);
    end(node_, SIGTERM);
    end(munge_, SIGTERM);
    ::unsetenv("SLURM_CONF");
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

}  // namespace seamwright
