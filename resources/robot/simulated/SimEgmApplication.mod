MODULE SimEgmApplication
    ! The robot program of the simulated controller with EGM: one path after the other by SeamwrightEgm.mod. The
    ! permission is that of the measuring controller beside it.
    PERS bool simPermitted:=FALSE;
    PERS bool simStopped:=FALSE;
    LOCAL CONST robtarget point:=[[0,0,0],[1,0,0,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];

    PROC main()
        SeamwrightEgmPath point,point,point,point,tool0,wobj0,v100;
        WaitTime @REST@;
    ENDPROC

    FUNC bool SW_Take(\num MaxTime)
        WaitUntil simPermitted OR simStopped\PollRate:=0.004;
        RETURN NOT simStopped;
    ENDFUNC
ENDMODULE
