# Completion of pliant for fish. It calls `pliant __complete WORD...`.

function __pliant_complete
    set -l words (commandline -opc)
    set -l word (commandline -ct)
    set -l lines ($words[1] __complete $words[2..-1] "$word" 2>/dev/null)
    set -l kind (string split ' ' -- $lines[1])
    # --name=value: keep the part before the value.
    set -l ahead (string match -r -- '^--[^=]*=' "$word")
    set -l part (string replace -r -- '^--[^=]*=' '' "$word")
    switch $kind[1]
        case words
            for line in $lines[2..-1]
                echo "$ahead$line"
            end
        case folders
            for file in (__fish_complete_directories $part)
                echo "$ahead$file"
            end
        case files
            for file in "$part"*
                if test -d $file
                    echo "$ahead$file/"
                else if test (count $kind) -eq 1
                    echo "$ahead$file"
                else
                    for ending in $kind[2..-1]
                        string match -q -- "*$ending" $file; and echo "$ahead$file"
                    end
                end
            end
    end
end

complete -c pliant -f -a '(__pliant_complete)'
