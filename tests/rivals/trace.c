// Executed instructions of functions, in order: trace COUNT ADDRESS:SIZE... -- PROGRAM ARGUMENTS...
// Each function, by its address and size in the file, is traced in its second call, up to COUNT instructions; the first call may still fault pages in.
// Prints a line for each traced function: its address, then the offsets of its instructions. Called functions are stepped through but not printed.
// Linux on x86-64. Build: cc -O2 trace.c -o trace
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#define MOST 64

static struct function {
    unsigned long address, size;
    long saved;
    int calls;
} functions[MOST];
static int number;
static unsigned long base;

static void fail(const char *what) {
    perror(what);
    exit(1);
}

// Replaces the first byte of a function, or restores it.
static void set_breakpoint(pid_t thread, struct function *it, int is_set) {
    void *at = (void *)(base + it->address);
    errno = 0;
    long word = ptrace(PTRACE_PEEKTEXT, thread, at, 0);
    if (errno) fail("peek");
    if (is_set) it->saved = word & 0xff;
    word = (word & ~0xffL) | (is_set ? 0xcc : it->saved);
    if (ptrace(PTRACE_POKETEXT, thread, at, word)) fail("poke");
}

static void step(pid_t thread, struct user_regs_struct *registers) {
    int status;
    if (ptrace(PTRACE_SINGLESTEP, thread, 0, 0)) fail("step");
    if (waitpid(thread, &status, __WALL) < 0 || !WIFSTOPPED(status)) fail("the program ended while it was traced");
    ptrace(PTRACE_GETREGS, thread, 0, registers);
}

// Prints the offsets of the instructions until the function returns.
static void trace(pid_t thread, struct function *it, long most) {
    struct user_regs_struct registers;
    ptrace(PTRACE_GETREGS, thread, 0, &registers);
    unsigned long stack = registers.rsp;
    printf("%lx", it->address);
    // A return pops its address, so that the stack is above that of the entry.
    for (long count = 0; count < most && registers.rsp <= stack;) {
        unsigned long offset = registers.rip - base - it->address;
        if (offset < it->size) printf(" %lx", offset), count++;
        step(thread, &registers);
    }
    printf("\n");
}

// Address that the file is loaded at.
static unsigned long load_address(pid_t process) {
    char name[64];
    unsigned long found = 0;
    snprintf(name, sizeof name, "/proc/%d/maps", process);
    FILE *maps = fopen(name, "r");
    if (!maps || fscanf(maps, "%lx", &found) != 1) fail("maps");
    fclose(maps);
    return found;
}

int main(int argc, char **argv) {
    int at = 2;
    if (argc < 5) return 2;
    long most = atol(argv[1]);
    for (; at < argc && strcmp(argv[at], "--") && number < MOST; at++, number++)
        if (sscanf(argv[at], "%lx:%lx", &functions[number].address, &functions[number].size) != 2) return 2;
    pid_t child = fork();
    if (child == 0) {
        ptrace(PTRACE_TRACEME, 0, 0, 0);
        execvp(argv[at + 1], argv + at + 1);
        _exit(127);
    }
    int status, left = number;
    waitpid(child, &status, 0);
    if (!WIFSTOPPED(status)) return 1;
    ptrace(PTRACE_SETOPTIONS, child, 0, PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL);
    base = load_address(child);
    for (int which = 0; which < number; which++) set_breakpoint(child, &functions[which], 1);
    ptrace(PTRACE_CONT, child, 0, 0);
    while (left > 0) {
        pid_t thread = waitpid(-1, &status, __WALL);
        if (thread < 0) break;
        if (!WIFSTOPPED(status)) continue;
        int sign = WSTOPSIG(status);
        if (sign == SIGTRAP && status >> 8 == SIGTRAP) {
            struct user_regs_struct registers;
            ptrace(PTRACE_GETREGS, thread, 0, &registers);
            for (int which = 0; which < number; which++) {
                struct function *it = &functions[which];
                if (registers.rip - 1 != base + it->address) continue;
                registers.rip--;
                ptrace(PTRACE_SETREGS, thread, 0, &registers);
                set_breakpoint(thread, it, 0);
                if (it->calls++ == 1) {
                    trace(thread, it, most);
                    left--;
                } else {
                    step(thread, &registers);
                    set_breakpoint(thread, it, 1);
                }
            }
            sign = 0;
        } else if (sign == SIGTRAP || sign == SIGSTOP) {
            sign = 0;
        }
        ptrace(PTRACE_CONT, thread, 0, (void *)(long)sign);
    }
    return left > 0;
}
