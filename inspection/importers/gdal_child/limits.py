"""What the child may do: read the files of its folder and write to its pipe, within limits of memory and processor time.

It cannot connect, start programs, or open files for writing: the kernel answers as if it had no such calls (seccomp, allow list).
"""

import ctypes
import os
import resource
import signal
import struct

MAX_FILES = 512
_SET_NO_NEW_PRIVILEGES, _SET_SECCOMP, _SET_PARENT_DEATH_SIGNAL, _SET_DUMPABLE = 38, 22, 1, 4  # prctl(2)
_FILTER = 2  # SECCOMP_MODE_FILTER
_ALLOW, _KILL, _NO_SUCH_CALL, _NO_ACCESS = 0x7FFF0000, 0x80000000, 0x00050000 | 38, 0x00050000 | 13  # SECCOMP_RET_*, ENOSYS, EACCES
_LOAD, _EQUAL, _ANY_BIT, _RETURN = 0x20, 0x15, 0x45, 0x06  # BPF
_NUMBER, _ARCHITECTURE, _ARGUMENTS = 0, 4, 16  # offsets in struct seccomp_data
_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC
_ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}  # AUDIT_ARCH_*; the numbers below are in this order
_OPEN, _OPENAT = (2, None), (257, 56)
_CALLS: dict[str, tuple[int, int | None]] = {
    "read": (0, 63), "write": (1, 64), "close": (3, 57), "stat": (4, None), "fstat": (5, 80), "lstat": (6, None), "poll": (7, None),
    "lseek": (8, 62), "mmap": (9, 222), "mprotect": (10, 226), "munmap": (11, 215), "brk": (12, 214), "rt_sigaction": (13, 134),
    "rt_sigprocmask": (14, 135), "rt_sigreturn": (15, 139), "ioctl": (16, 29), "pread64": (17, 67), "readv": (19, 65), "writev": (20, 66),
    "access": (21, None), "sched_yield": (24, 124), "mremap": (25, 216), "madvise": (28, 233), "dup": (32, 23), "nanosleep": (35, 101),
    "getpid": (39, 172), "exit": (60, 93), "uname": (63, 160), "fcntl": (72, 25), "getcwd": (79, 17), "readlink": (89, None),
    "gettimeofday": (96, 169), "getrusage": (98, 165), "sysinfo": (99, 179), "getuid": (102, 174), "getgid": (104, 176),
    "geteuid": (107, 175), "getegid": (108, 177), "sigaltstack": (131, 132), "statfs": (137, 43), "fstatfs": (138, 44),
    "gettid": (186, 178), "futex": (202, 98), "sched_getaffinity": (204, 123), "getdents64": (217, 61), "restart_syscall": (219, 128),
    "clock_gettime": (228, 113), "clock_getres": (229, 114), "clock_nanosleep": (230, 115), "exit_group": (231, 94),
    "newfstatat": (262, 79), "readlinkat": (267, 78), "faccessat": (269, 48), "ppoll": (271, 73), "getrandom": (318, 278),
    "membarrier": (324, 283), "statx": (332, 291), "rseq": (334, 293), "faccessat2": (439, 439),
}  # fmt: skip


def set_limits(memory_bytes: int, processor_s: int, most_processor_s: int) -> None:
    """Limit this process for good. most_processor_s: up to which the parent may raise its processor time."""
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(_SET_PARENT_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)
    libc.prctl(_SET_DUMPABLE, 0, 0, 0, 0)
    for limit, most in (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_NOFILE, MAX_FILES + 64),
    ):
        resource.setrlimit(limit, (most, most))
    resource.setrlimit(resource.RLIMIT_CPU, (processor_s, max(processor_s, most_processor_s)))
    _filter_calls(libc)


def _filter_calls(libc: ctypes.CDLL) -> None:
    program = _program(os.uname().machine)
    code = ctypes.create_string_buffer(program)
    filters = struct.pack("HL", len(program) // 8, ctypes.addressof(code))
    for option, value, argument in ((_SET_NO_NEW_PRIVILEGES, 1, 0), (_SET_SECCOMP, _FILTER, ctypes.c_char_p(filters))):
        if libc.prctl(option, value, argument, 0, 0):
            raise OSError(ctypes.get_errno(), "the kernel does not take the filter of calls (seccomp)")


def _program(machine: str) -> bytes:
    """Return the filter. Raises KeyError for a machine whose numbers of calls are not listed."""
    code = [(_LOAD, 0, 0, _ARCHITECTURE), (_EQUAL, 1, 0, _ARCHITECTURES[machine]), (_RETURN, 0, 0, _KILL), (_LOAD, 0, 0, _NUMBER)]
    column = list(_ARCHITECTURES).index(machine)
    for numbers in _CALLS.values():
        if (number := numbers[column]) is not None:
            code += [(_EQUAL, 0, 1, number), (_RETURN, 0, 0, _ALLOW)]
    for numbers, flags in ((_OPEN, 1), (_OPENAT, 2)):
        if (number := numbers[column]) is not None:
            code += [(_EQUAL, 0, 4, number), (_LOAD, 0, 0, _ARGUMENTS + 8 * flags), (_ANY_BIT, 0, 1, _WRITING)]
            code += [(_RETURN, 0, 0, _NO_ACCESS), (_RETURN, 0, 0, _ALLOW)]
    code.append((_RETURN, 0, 0, _NO_SUCH_CALL))
    return b"".join(struct.pack("HBBI", *line) for line in code)
