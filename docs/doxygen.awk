# SPDX-License-Identifier: BSD-3-Clause
# What Doxygen reads of a public header. The header has plain comments: a block above a declaration and one behind it.
# Both become Doxygen's (/// and ///<). A block is also that of the declarations right below the first, up to an empty
# line, and of each name where a declaration has several. The first block is the file's, and one that an empty line follows
# is nobody's.
function put(prefix, i)
{
    for (i = 1; i <= n; i++)
        print indent prefix block[i]
}
function flush_loose()
{
    if (n && !told && !/SPDX/) {
        print "/// @file"
        put("///")
        told = 1
    } else
        put("//")
    n = 0
}
# A comment on a line of its own.
/^ *\/\// && !/SPDX-License/ {
    match($0, /\/\//)
    if (behind == RSTART) {  # goes on behind the declaration above
        print substr($0, 1, RSTART - 1) "///<" substr($0, RSTART + 2)
        next
    }
    if (!n)
        indent = substr($0, 1, RSTART - 1)
    block[++n] = substr($0, RSTART + 2)
    fresh = 1
    behind = 0
    next
}
/^ *$/ || /SPDX-License/ {
    if (fresh)
        flush_loose()
    n = fresh = behind = 0
    print
    next
}
# Room for fields of later versions.
/^ +[a-z][a-z0-9_ *]* reserved(\[[0-9A-Z_]+\])?;$/ {
    print $0 "  ///< Room for fields of later versions."
    next
}
{
    code = $0
    if (match(code, /[^ ] *\/\//) && !/^ *#include/) {
        at = index(code, "//")
        each(substr(code, 1, at - 1), "", "///<" substr(code, at + 2))
        behind = at
        n = fresh = 0
        next
    }
    behind = 0
    # A declaration that begins here; lines that go on, braces and the preprocessor's are none.
    told_here = n && (fresh || (whole && code !~ /^ *[}#]/))
    fresh = 0
    each(code, told_here ? "///" : "", "")
    if (code ~ /\{ *$/)  # what is inside has comments of its own
        n = 0
    whole = code ~ /[;,]$/ && paren(code) == 0
}
# int a, b; as one declaration each: before is the prefix of the block, after the comment behind.
function each(code, before, after, type, names, count, i)
{
    if (code !~ /^ +[a-z][a-z0-9_ ]*[ *]+[a-z_0-9\[\]]+(, [a-z_0-9\[\]]+)+; *$/) {
        if (before)
            put(before)
        print code after
        return
    }
    count = split(code, names, /, |; *$/) - 1
    match(names[1], /[a-z_0-9\[\]]+$/)
    type = substr(names[1], 1, RSTART - 1)
    names[1] = substr(names[1], RSTART)
    for (i = 1; i <= count; i++) {
        if (before)
            put(before)
        print type names[i] "; " after
    }
}
function paren(s, open, close_)
{
    open = gsub(/\(/, "(", s)
    close_ = gsub(/\)/, ")", s)
    depth += open - close_
    return depth
}
