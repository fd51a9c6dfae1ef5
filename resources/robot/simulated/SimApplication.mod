MODULE SimApplication
    ! The robot program of the simulated cell, as a plant writes it: waits for the line's call or for a run at the
    ! computer, measures, and lays a short bead where the part is released. While spots are taught (manual mode)
    ! it serves moves.
    PERS bool simCalled:=FALSE;
    PERS string simPart:="";
    PERS num simBeads:=0;
    PERS num simWait:=@WAIT@;

    PROC main()
        IF simCalled THEN
            swPart:=simPart;
            simCalled:=FALSE;
            SW_Measure;
            Work;
        ELSEIF SW_Asked() THEN
            SW_Measure\Asked;
            Work;
        ELSEIF OpMode()=OP_AUTO OR OpMode()=OP_UNDEF THEN
            WaitTime 0.004;
        ELSE
            SW_Teach;
        ENDIF
    ENDPROC

    LOCAL PROC Work()
        VAR num stood:=0;
        VAR num waited:=0;
        VAR robtarget begin;
        ! The nozzle is made ready: the permission lies so long.
        WHILE stood<simWait AND waited<20 AND (NOT SW_Over()) DO
            WaitTime 0.005;
            IF swGivenFor=swPartNo THEN
                stood:=stood+0.005;
            ELSE
                stood:=0;
                waited:=waited+0.005;
            ENDIF
        ENDWHILE
        IF SW_Take() THEN
            ConfL\Off;
            begin:=CRobT(\Tool:=swTool\WObj:=@FRAME@);
            MoveL Offs(begin,0,0,2),v100,z1,swTool\WObj:=@FRAME@;
            MoveL Offs(begin,10,0,2),v100,z1,swTool\WObj:=@FRAME@;
            MoveL begin,v100,fine,swTool\WObj:=@FRAME@;
            ConfL\On;
            simBeads:=simBeads+1;
        ENDIF
    ENDPROC
ENDMODULE
